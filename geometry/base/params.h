// Params: how a component reads its parameters, and at the same time how it documents them.
//
//   spread_ = params.real("spread", 0.4, {0, 180, "deg"}, "opening angle of a frond");
//
// The line that reads a parameter declares its name, type, unit, range, default and meaning. Read over a Value it
// checks type and range and returns the user's value or the default; every error goes to the Diagnostics with its place
// and reading goes on with the default. Run without a Value (describe mode) the same constructor yields the list of
// ParamInfo from which `meristem describe`, the JSON Schema and the manual pages are made. So a constructor must accept
// its own defaults. finish() (called by the registry after construction) reports unknown keys with the nearest name.
#pragma once

#include "geometry/base/value.h"
#include "geometry/base/vec.h"

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace meristem {

class Expression;
class Symbols;

// The closed range a number must lie in, and its unit ("m", "deg", "s", "px"; empty: none).
struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  const char* unit = "";
};
constexpr Range any_range{};
constexpr Range unit_range{0, 1, ""};
constexpr Range not_negative{0, std::numeric_limits<double>::infinity(), ""};

// "0 to 180 deg", "at least 0 m", "at most 1"; an empty text if every number is inside.
std::string range_text(const Range& range);

struct ParamInfo {
  enum class Type {
    Real,
    Integer,
    Boolean,
    Text,
    Choice,
    Vector,
    Color,
    ScalarExpression,
    VectorExpression,
    Component,
    Raw
  };
  std::string name{};
  Type type = Type::Real;
  Range range{};
  bool required = false;
  std::string default_text{};          // as it would be written in a scene file
  std::vector<std::string> choices{};  // of a Choice
  std::string component_kind{};        // of a Component: "light", "filter", ...
  std::string schema{};                // of a Raw: a JSON Schema fragment; may be empty (anything)
  bool takes_time = false;             // a Real, Vector or Color may be written as an expression of `time`
  std::string doc{};
};

class Params {
 public:
  // Reads the object `value` (whose lifetime must exceed the Params'). `what` names the component in messages:
  // light "sky".
  Params(const Value& value, std::string what, Diagnostics& diagnostics);
  // Describe mode: every read returns its default and is recorded in `infos`.
  explicit Params(std::vector<ParamInfo>& infos);

  bool describing() const { return value_ == nullptr; }
  const Location& location() const;  // of the object
  Diagnostics& diagnostics() { return *diagnostics_; }
  bool has(const char* name) const;              // the user wrote it
  Location location_of(const char* name) const;  // of the member's value; the object's if it is not written

  // From here on real(), vector(), color() and those that are required also take expressions of `time` as text, which
  // are evaluated in the TimeScope (geometry/fields/time.h) in which they are read.
  void allow_time() { allows_time_ = true; }
  // `value` as it is now: `components` (1 or 3) numbers for a text, a number for each text in a list, all else as it
  // is; in `storage` if that is another Value. Null, after an error, if an expression in it is wrong.
  const Value* now(const Value& value, int components, Value& storage);

  double real(const char* name, double fallback, Range range, const char* doc);
  int integer(const char* name, int fallback, Range range, const char* doc);
  bool boolean(const char* name, bool fallback, const char* doc);
  std::string text(const char* name, const char* fallback, const char* doc);
  // The index of the chosen name in `names`.
  int choice(const char* name, int fallback, const std::vector<std::string>& names, const char* doc);
  Vec3d vector(const char* name, Vec3d fallback, Range range, const char* doc);  // [x, y, z]
  // Scene-linear Rec.709: [r, g, b] or one number for grey; not negative.
  Vec3d color(const char* name, Vec3d fallback, const char* doc);

  // In describe mode and after an error: clamp(1, range).
  double required_real(const char* name, Range range, const char* doc);
  Vec3d required_vector(const char* name, const char* doc);
  std::string required_text(const char* name, const char* doc);

  // An expression of geometry/fields over `symbols`: written as text, as a number, or (vector) as [x, y, z].
  // `fallback` is an expression text that must compile. Errors of the expression point into the user's string.
  std::shared_ptr<const Expression> scalar_expression(const char* name, const char* fallback, const Symbols& symbols,
                                                      const char* doc);
  std::shared_ptr<const Expression> vector_expression(const char* name, const char* fallback, const Symbols& symbols,
                                                      const char* doc);

  // Anything of its own shape (rules, steps, lists): the Value as written, nullptr if it is not. `schema` is a JSON
  // Schema fragment.
  const Value* raw(const char* name, bool required, const char* schema, const char* doc);

  void error(const char* name, std::string message) { diagnostics_->error(location_of(name), std::move(message)); }
  // Reports every key that was not read, with the nearest known name. Nothing in describe mode.
  void finish();

 private:
  const Value* take(ParamInfo info);  // records or looks up; marks the key as known
  // The same for what may depend on time: as it is now.
  const Value* take_timed(ParamInfo info, int components, Value& storage);
  // Each reports what does not fit; accept() says whether it did.
  void mismatch(const char* name, const Value& value, std::string_view expected);
  bool accept(const char* name, const Value& value, const Range& range);
  bool accept_vector(const char* name, const Value& value, const Range& range);
  Vec3d read_vector(const char* name, const Value* value, Vec3d fallback, const Range& range);

  const Value* value_ = nullptr;
  std::string what_;
  std::shared_ptr<Diagnostics> unheard_;  // in describe mode, for a constructor that asks for diagnostics()
  Diagnostics* diagnostics_ = nullptr;
  std::vector<ParamInfo>* infos_ = nullptr;
  std::vector<std::string> known_;
  bool allows_time_ = false;
};

}  // namespace meristem
