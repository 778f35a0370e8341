// BaseShape: the mesh that a model starts from, M(0). One file a shape in procedural/growth/bases; each reads which
// symbols its faces carry: { "type": "prism", "sides": 8, "cap": "shoot(1)" }.
//
// Shapes stand on the plane y = 0 where they can. Immutable after construction.
#pragma once

#include "geometry/base/registry.h"
#include "geometry/cells/step.h"
#include "geometry/mesh/mesh.h"
#include "geometry/mesh/quantum.h"
#include "procedural/growth/growth_symbols.h"
#include "procedural/growth/named_faces.h"

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace meristem {

// What building needs of the model; the symbols get those that the base names.
struct BaseContext {
  GrowthSymbols& symbols;
  Diagnostics& diagnostics;
  Key seed = 0;  // for rand() in the symbols' parameters
  std::int32_t material = -1;
  std::string folder = {};  // of the scene's assets
  std::function<int(const std::string& name, const Location& where)> material_index =
      {};                                    // reports unknown names itself
  std::uint16_t production = no_production;  // that stands for the base itself
  ProductionNumber production_number = no_production_numbers;
};

class BaseShape {
 public:
  virtual ~BaseShape() = default;
  // The mesh with keys, symbols, corner_uv and, where there are creases, corner_sharpness. Positions are not yet on a
  // grid.
  Mesh build(BaseContext& context) const;
  // Steps of its own that go before those of the model: how a shape that is a seed grows into what it stands for.
  // `is_refined`: whether subdivision follows.
  virtual std::vector<std::unique_ptr<Step>> growth(const BaseContext& context, bool is_refined) const {
    (void)context, (void)is_refined;
    return {};
  }

 protected:
  // The symbol, written as text, of a kind of faces.
  struct FaceSymbol {
    std::string text;
    Location location;
  };
  static FaceSymbol read_symbol(Params& params, const char* name, const char* doc);

  virtual NamedFaces outline(BaseContext& context) const = 0;
  // Whether its textures may have seams that are to stay through subdivision.
  virtual bool keeps_seams() const { return false; }
  // The symbol of the faces with that name; null: none.
  virtual const FaceSymbol* symbol_of(int name) const = 0;
};

using BaseRegistry = Registry<BaseShape>;

// Moves every vertex to the nearest point of the grid.
void snap_to_grid(Mesh& mesh, const Quantum& quantum);

// A prism over a ring at y = 0 that runs counter-clockwise seen from above: sides, bottom and cap with the given names.
// Corner 0 of the cap stands over ring[0]; u is given a corner, v is the height. `crease`: the sharpness of both rims.
struct PrismNames {
  int cap, bottom, side;
};
NamedFaces make_prism(std::span<const Vec3d> ring, std::span<const double> u, double height, PrismNames names,
                      double crease);

}  // namespace meristem
