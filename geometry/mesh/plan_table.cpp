#include "geometry/mesh/plan_table.h"

namespace meristem {

namespace {

class ShapeHasher {
 public:
  template <class T>
  void add(const std::vector<T>& values) {
    add_word(values.size());
    for (const T& v : values) {
      std::uint32_t bits = 0;
      static_assert(sizeof(T) == sizeof(bits));
      __builtin_memcpy(&bits, &v, sizeof(bits));
      add_word(bits);
    }
  }
  void add_word(std::uint64_t w) {
    name_.first = (name_.first ^ w) * 0x9e3779b97f4a7c15ull;
    name_.first ^= name_.first >> 29;
    name_.second = (name_.second + w) * 0xd1342543de82ef95ull;
    name_.second ^= name_.second >> 32;
  }
  ShapeName name() const { return name_; }

 private:
  ShapeName name_{0x243f6a8885a308d3ull, 0x13198a2e03707344ull};
};

}  // namespace

ShapeName shape_name(const Mesh& mesh, std::uint32_t owned_faces, std::uint64_t options) {
  ShapeHasher hasher;
  hasher.add_word(owned_faces);
  hasher.add_word(options);
  hasher.add(mesh.face_starts);
  hasher.add(mesh.corner_vertices);
  hasher.add(mesh.corner_sharpness);
  hasher.add(mesh.vertex_sharpness);
  return hasher.name();
}

}  // namespace meristem
