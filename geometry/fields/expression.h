// Expression: one compiled formula of the expression language (docs/expressions.md), the language of vertex placement,
// attributes, productions, material patterns and scattering. Syntax and function names are those of Disney's SeExpr 2.
//
// Total: no loops, no state, no input or output; every operation has a defined finite or IEEE result. Compiled once to
// a graph; evaluated over blocks of points with SIMD (same bits on every instruction set and for any split into blocks:
// lanes never mix, no fused multiply-add), and over intervals for bounds. Immutable after compile(): any thread may
// evaluate; scratch memory is per thread and allocates only while it grows.
#pragma once

#include "geometry/base/key.h"
#include "geometry/base/vec.h"

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace meristem {

enum class ValueType : std::uint8_t { Scalar, Vector };

// The variables an expression may read, in the order in which inputs are passed. Copyable; names are unique.
class Symbols {
 public:
  // Returns the variable's slot. `doc` goes into error messages and manual pages ("local normal, unit").
  int add(std::string name, ValueType type, std::string doc = {});
  int find(std::string_view name) const;  // -1 if unknown
  int size() const { return int(entries_.size()); }
  const std::string& name(int slot) const { return entries_[std::size_t(slot)].name; }
  ValueType type(int slot) const { return entries_[std::size_t(slot)].type; }
  const std::string& doc(int slot) const { return entries_[std::size_t(slot)].doc; }

 private:
  struct Entry {
    std::string name;
    ValueType type;
    std::string doc;
  };
  std::vector<Entry> entries_;
};

struct ExpressionError : std::runtime_error {
  ExpressionError(const std::string& message, std::size_t offset_, std::size_t length_)
      : std::runtime_error(message), offset(offset_), length(length_) {}
  std::size_t offset;  // bytes from the start of the text
  std::size_t length;
};

// One input: structure of arrays. Scalars use x alone. stride 1: one value a point; stride 0: one value for all.
struct Input {
  const float* x = nullptr;
  const float* y = nullptr;
  const float* z = nullptr;
  int stride = 1;
};

// The points of one evaluation. `inputs` has one entry for each slot of the Symbols (those the expression does not use
// may be null).
struct Block {
  int count = 0;  // any number; evaluated in runs of a fixed size inside
  std::span<const Input> inputs;
  const Key* keys = nullptr;  // one a point, for rand(); null: all zero
  Key salt = 0;               // hashed into every rand(): scene seed and step
};

// A closed interval, and for vectors three of them with a bound on the length of the vector.
struct Interval {
  float lower = 0, upper = 0;
};
struct IntervalValue {
  Interval x, y, z;                                           // scalars use x alone
  float max_length = std::numeric_limits<float>::infinity();  // of a vector; infinity: only the components bound it

  static IntervalValue scalar(float lower, float upper) {
    return {{lower, upper}, {}, {}, std::numeric_limits<float>::infinity()};
  }
  static IntervalValue unit_vector() { return {{-1, 1}, {-1, 1}, {-1, 1}, 1}; }  // of length at most 1
};

class Expression {
 public:
  // Compiles text whose result must be of the wanted type (a scalar is accepted for a vector: all three components).
  // Throws ExpressionError with the place, what is wrong and what would have been right (nearest name).
  static std::shared_ptr<const Expression> compile(std::string_view text, const Symbols& symbols, ValueType wanted);

  virtual ~Expression() = default;
  virtual ValueType type() const = 0;
  virtual bool is_constant() const = 0;  // depends on no variable and no rand()
  virtual bool uses(int slot) const = 0;
  virtual bool uses_random() const = 0;
  virtual const std::string& text() const = 0;

  // Writes block.count results; y and z are null for a scalar. Outputs must not overlap inputs.
  virtual void evaluate(const Block& block, float* x, float* y, float* z) const = 0;
  // One interval a slot; the result holds every value evaluate() can give for inputs inside them and for any key
  // (NaN aside).
  virtual IntervalValue evaluate_bounds(std::span<const IntervalValue> inputs) const = 0;

  // One point, for constants and per-face parameters: `values` holds one Vec3f a slot (scalars in x).
  float evaluate_scalar(std::span<const Vec3f> values, Key key = 0, Key salt = 0) const;
  Vec3f evaluate_vector(std::span<const Vec3f> values, Key key = 0, Key salt = 0) const;

 protected:
  virtual Vec3f evaluate_point(std::span<const Vec3f> values, Key key, Key salt) const = 0;
};

}  // namespace meristem
