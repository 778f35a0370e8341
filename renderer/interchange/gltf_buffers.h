// The bytes of a glTF 2.0 file: its JSON with positions, its buffers, and accessors into them with every bound checked.
#pragma once

#include "geometry/base/value.h"
#include "geometry/base/vec.h"

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace meristem {

class GltfBuffers {
 public:
  // A .gltf or .glb file of at most 1 GiB, and the .bin files it names in its folder or below. Mistakes go to the
  // diagnostics; what is read then is empty.
  GltfBuffers(const std::string& path, Diagnostics& diagnostics);

  const Value& json() const { return json_; }
  const std::string& folder() const { return folder_; }

  // The item of one of the arrays of the file's root that `index` names; null, with an error at the index if there is
  // one, if there is none.
  const Value* item(const char* array, const Value* index);

  // The numbers of an accessor, `width` each; normalised integers as fractions. Empty, with an error, if anything is
  // wrong.
  std::vector<float> floats(const Value* index, int width);
  std::vector<std::uint32_t> indices(const Value* index, std::size_t vertices);
  // Of a view, for images.
  std::string_view view(const Value* index);

 private:
  struct Accessor {
    const char* first = nullptr;
    std::size_t count = 0, stride = 0;
    int component = 0, width = 0;
    bool normalized = false;
  };
  void read_glb(const std::string& path);
  void read_json(const std::string& path, std::string text);
  void read_buffers();
  bool accessor(const Value* index, Accessor& accessor);
  double component(const Accessor& accessor, std::size_t item, int i) const;
  bool error(const Location& where, std::string message);

  Diagnostics& diagnostics_;
  std::string folder_;
  Value json_;
  std::string binary_;  // of a .glb
  std::vector<std::string> buffers_;
};

// A member that is a whole number from 0 on; `fallback` if it is missing or none.
std::size_t gltf_count(const Value& object, const char* name, std::size_t fallback);
double gltf_number(const Value* object, const char* name, double fallback);

}  // namespace meristem
