// The parameters of one statement of a pbrt scene file: "float fov" [ 40 ] and so on. What nobody asks for is left out
// of the converted scene, and can be listed.
#pragma once

#include "geometry/base/vec.h"
#include "renderer/interchange/pbrt_tokens.h"

#include <string>
#include <vector>

namespace meristem {

struct PbrtParameter {
  std::string type, name;
  Location where;
  std::vector<double> numbers;
  std::vector<std::string> texts;  // of strings, textures, named spectra
  std::vector<bool> booleans;
  bool is_used = false;
};

class PbrtParameters {
 public:
  // Reads parameters up to the next statement.
  PbrtParameters(PbrtTokens& tokens, Diagnostics& diagnostics);
  // None.
  explicit PbrtParameters(Diagnostics& diagnostics) : diagnostics_(diagnostics) {}

  // Null if it is not given.
  const PbrtParameter* find(std::string_view name);
  double number(std::string_view name, double fallback);
  int integer(std::string_view name, int fallback) { return int(number(name, fallback)); }
  bool boolean(std::string_view name, bool fallback);
  std::string text(std::string_view name, const std::string& fallback);
  // Triples or pairs of numbers; an error if the count is not a multiple.
  std::vector<Vec3d> points(std::string_view name);
  std::vector<Vec2d> pairs(std::string_view name);
  std::vector<std::uint32_t> indices(std::string_view name, std::size_t vertices);

  const std::vector<PbrtParameter>& list() const { return list_; }

 private:
  void read_values(PbrtTokens& tokens, PbrtParameter& parameter);
  void add_value(const PbrtToken& token, PbrtParameter& parameter);

  Diagnostics& diagnostics_;
  std::vector<PbrtParameter> list_;
};

}  // namespace meristem
