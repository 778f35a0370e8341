// The textures of one material: image files whose colours its expressions read by name.
//
//   "textures": { "bark": { "file": "bark.jpg", "u": "4*u" } }, "base_color": "bark * [1, 0.9, 0.8]"
//
// The member is an object by name; of each, `file` stands in the scene's folder or below it, `u` and `v` are
// expressions over the symbols of material_symbols.h. A lookup is the mean over the footprint of the point that is
// shaded, as far as the texture's `filter` goes. Immutable; any thread.
#pragma once

#include "renderer/image/texture.h"
#include "renderer/materials/material_symbols.h"

#include <memory>
#include <vector>

namespace meristem {

class MaterialTextures {
 public:
  // Reads the member "textures".
  explicit MaterialTextures(Params& params);

  // material_symbols(), and the textures' names.
  const Symbols& symbols() const { return symbols_; }
  bool empty() const { return entries_.empty(); }
  // The values of all of them at a hit.
  MaterialValues at(const ShadingPoint& point) const;

 private:
  struct Entry {
    std::shared_ptr<const Expression> u, v;
    std::unique_ptr<const Texture> texture;
    float filter = 0;  // how much of the footprint's width
  };
  class Neighbours;
  void add(const std::string& name, const Value& value, Diagnostics& diagnostics);

  Symbols symbols_ = material_symbols();
  std::vector<Entry> entries_;
};

}  // namespace meristem
