// GrowthSymbols: the alphabet of a model's mesh-based L-system (the paper's section 4): the symbols that faces carry,
// each with the number of its parameters, shared by the base mesh and all grow steps of the model.
//
// A symbol comes into being where it is first named: by the head of a rule, "shoot(len, r)", or by a use,
// "shoot(0.9*len, r)". All heads and uses must agree on the number of parameters (at most max_growth_parameters).
// A symbol that no rule has is a terminal: it stays on its face. Filled while loading (one thread), then read-only.
#pragma once

#include "geometry/base/value.h"
#include "geometry/fields/expression.h"
#include "geometry/mesh/mesh.h"

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace meristem {

class GrowthSymbols {
 public:
  struct Entry {
    std::string name;
    int parameter_count = 0;
    Location first;         // where it was first named
    int last_rule = -1;     // the model's last grow step (counted over all of them) with a rule for it; -1: none has
    bool has_rule = false;  // perhaps in an entry that says 0 steps
    int productions = 0;    // that steps have for it so far
    std::vector<int> makes = {};  // symbols of faces that these make
    bool is_on_base = false;
  };

  int size() const { return int(entries_.size()); }
  int find(std::string_view name) const;  // -1 if unknown
  const Entry& entry(int symbol) const { return entries_[std::size_t(symbol)]; }

  // The symbol of that name, made if it is new; -1, and an error, if the number of parameters contradicts an earlier
  // one.
  int use(const std::string& name, int parameter_count, const Location& where, Diagnostics& diagnostics);
  // Notes that the grow step of that index has a rule for the symbol.
  void add_rule(int symbol, int step);
  // Notes that a production of the symbol makes faces with another.
  void add_successor(int symbol, int made) { entries_[std::size_t(symbol)].makes.push_back(made); }
  // Notes that the base mesh may have faces with the symbol.
  void put_on_base(int symbol) { entries_[std::size_t(symbol)].is_on_base = true; }
  // A number for another production of the symbol, in the order in which they stand in the file, from 0.
  int number_production(int symbol) { return entries_[std::size_t(symbol)].productions++; }
  // Warns of terminals whose name is near that of a symbol with a rule. Called once after all steps are read.
  void report_terminals(Diagnostics& diagnostics) const;
  // Warns of rules that no face can meet in any number of steps, whatever their conditions; not of those that only
  // such rules lead to. Called once after all steps are read and the base is built,
  // without errors.
  void report_unreachable(Diagnostics& diagnostics) const;

 private:
  std::vector<std::string> names(bool with_rules) const;
  std::vector<Entry> entries_;
};

// The number, over the whole scene, under which faces remember what made them (FaceOrigin::production), by what the
// model calls it: "shoot[2]", the third production of that symbol.
using ProductionNumber = std::function<std::uint16_t(const std::string& name)>;
// For whoever does not want to know.
inline std::uint16_t no_production_numbers(const std::string&) { return no_production; }

// "name(a, b)" taken apart: a name and the texts between the commas of the outermost parentheses.
struct SymbolText {
  struct Argument {
    std::string text;
    std::size_t offset;  // in the whole text
  };
  std::string name;
  std::vector<Argument> arguments;
};
// `start` is the place of the text's first byte.
std::optional<SymbolText> parse_symbol_text(std::string_view text, const Location& start, Diagnostics& diagnostics);

// A symbol with expressions for its parameters: what a rule puts on a new face, or the scene on a face of the base
// mesh.
class Successor {
 public:
  // No symbol.
  Successor() = default;
  // Reads a value such as "shoot(len*0.92)" over the given variables; no symbol after an error. Empty text: no symbol.
  Successor(const std::string& text, const Location& quote, const Symbols& variables, GrowthSymbols& symbols,
            Diagnostics& diagnostics);

  int symbol() const { return symbol_; }
  // Does a parameter read the variable of that slot?
  bool uses(int slot) const;
  // Sets the symbol and the parameters of `origin`. A face one of whose parameters is not a number gets no symbol.
  void evaluate(std::span<const Vec3f> values, Key key, Key salt, FaceOrigin& origin) const;
  std::array<Interval, max_growth_parameters> bounds(std::span<const IntervalValue> values) const;

 private:
  int symbol_ = -1;
  std::vector<std::shared_ptr<const Expression>> arguments_;
};

// Compiles an expression inside the user's text; null, and an error at its place, if it is wrong.
std::shared_ptr<const Expression> compile_at(const std::string& text, const Location& start, const Symbols& variables,
                                             ValueType wanted, Diagnostics& diagnostics);

}  // namespace meristem
