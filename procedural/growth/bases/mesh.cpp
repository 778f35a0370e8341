// mesh: any manifold mesh, inline or from an OBJ or PLY file; "symbols" says which symbol the faces of a name carry,
// and "creases" are edges with their sharpness: [[0, 1, 2.5], ...] for the edge between vertices 0 and 1.
#include "procedural/growth/base_shape.h"
#include "procedural/growth/mesh_source.h"

#include <fmt/format.h>

#include <map>

namespace meristem {

namespace {

class BaseFromMesh : public BaseShape {
 public:
  explicit BaseFromMesh(Params& params) : source_(params) {
    const Value* symbols = params.raw("symbols", false, R"({"type":"object","additionalProperties":{"type":"string"}})",
                                      "symbols of the faces by their names, such as { \"tip\": \"shoot(1)\" }");
    const Value* creases =
        params.raw("creases", false, R"({"type":"array"})", "edges and their sharpness: [[0, 1, 2.5], ...]");
    if (symbols) read_symbols(*symbols, params.diagnostics());
    if (creases) read_creases(*creases, params.diagnostics());
  }

 private:
  struct Crease {
    std::uint32_t a, b;
    float sharpness;
    Location location;
  };

  void read_symbols(const Value& symbols, Diagnostics& diagnostics) {
    if (symbols.kind != Value::Kind::Object)
      return diagnostics.error(symbols.location, "expected an object: names of faces and their symbols");
    for (const Member& m : symbols.members) {
      if (m.value.kind != Value::Kind::Text)
        diagnostics.error(m.value.location, fmt::format("expected a symbol as text, found {}", m.value.kind_name()));
      else
        symbols_[m.key] = {{m.value.text, m.value.location}, m.key_location};
    }
  }

  void read_creases(const Value& list, Diagnostics& diagnostics) {
    if (list.kind != Value::Kind::Array) return diagnostics.error(list.location, "expected an array of creases");
    for (const Value& item : list.items) {
      bool good = item.kind == Value::Kind::Array && item.items.size() == 3;
      for (const Value& number : item.items)
        good = good && number.kind == Value::Kind::Number && number.number >= 0 && number.number < 1e9;
      if (!good || item.items[2].number > 10) {
        diagnostics.error(item.location, "expected two vertices and a sharpness from 0 to 10");
        continue;
      }
      creases_.push_back({std::uint32_t(item.items[0].number), std::uint32_t(item.items[1].number),
                          float(item.items[2].number), item.location});
    }
  }

  NamedFaces outline(BaseContext& context) const override {
    NamedMesh mesh = source_.load(context.folder, context.diagnostics);
    for (const auto& [name, symbol] : symbols_) {
      if (std::find(mesh.names.begin(), mesh.names.end(), name) != mesh.names.end()) continue;
      const std::string_view near = nearest_name(name, mesh.names);
      context.diagnostics.error(symbol.name_location,
                                fmt::format("the mesh has no face named \"{}\"{}", name,
                                            near.empty() ? "" : fmt::format("; did you mean \"{}\"?", near)));
    }
    for (const Crease& c : creases_) mesh.faces.crease_edge(c.a, c.b, c.sharpness);
    number_names(mesh);
    return std::move(mesh.faces);
  }

  bool keeps_seams() const override { return true; }

  // Names of faces become indices into the symbols in their order; -1 for those without.
  void number_names(NamedMesh& mesh) const {
    for (int& name : mesh.faces.names) {
      const auto symbol = symbols_.find(mesh.names[std::size_t(name)]);
      name = symbol == symbols_.end() ? -1 : int(std::distance(symbols_.begin(), symbol));
    }
  }
  const FaceSymbol* symbol_of(int name) const override {
    return name < 0 ? nullptr : &std::next(symbols_.begin(), name)->second.symbol;
  }

  struct NamedSymbol {
    FaceSymbol symbol;
    Location name_location;
  };
  MeshSource source_;
  std::map<std::string, NamedSymbol> symbols_;
  std::vector<Crease> creases_;
};

}  // namespace

void register_mesh(BaseRegistry& r) {
  r.add<BaseFromMesh>("mesh", "Any mesh, written inline or read from an OBJ or PLY file");
}

}  // namespace meristem
