// Children of a stem: the same bits with every instruction set and wherever they stand in their rows, and where frames
// turned one by one put them.
#include "procedural/plants/child_kernels.h"
#include "geometry/fields/kernels.h"
#include "tests/procedural/plants/plant_support.h"

namespace meristem::test {
namespace {

struct Joints {
  StemNode a, b;
};

Joints joints_of(Key key) {
  const Draws draws(key);
  const auto any = [&](Key what) { return 2 * draws.uniform(what) - 1; };
  Joints j;
  turn_about_x(j.a.frame, 3 * any(1));
  turn_about_y(j.a.frame, 3 * any(2));
  j.a.frame.origin = {any(3), any(4), any(5)};
  j.b.frame = j.a.frame;
  j.b.frame.origin += j.a.frame.z * 0.5 + j.a.frame.x * (0.2 * any(6));
  j.a.tangent = j.a.frame.z;
  j.b.tangent = normalize(j.a.frame.z + j.a.frame.y * any(7));
  return j;
}

// Children with numbers of their own, the first of them `shift` behind where they would be.
ChildRows children_of(std::size_t count, std::size_t shift = 0) {
  ChildRows children;
  children.make_room(count + shift);
  for (std::size_t i = 0; i < count + shift; ++i) {
    const Draws draws(i < shift ? 1000 + i : i - shift);
    children.add(i);
    children.view()[ChildRows::part][i] = draws.uniform(1);
    children.view()[ChildRows::around][i] = 100 * draws.uniform(2);
    children.view()[ChildRows::away][i] = 3 * draws.uniform(3);
  }
  return children;
}

void place(const ChildKernels& kernels, const Joints& joints, std::size_t begin, ChildRows& children) {
  kernels.put_on_axis(joints.a, joints.b, children.view(), begin, children.size());
  kernels.turn_away(children.view(), children.size());
  kernels.turn_to_light(children.view(), children.size(), 0.3);
}

std::vector<const ChildKernels*> usable_child_kernels() {
  std::vector<const ChildKernels*> usable{&baseline_child_kernels()};
  if (usable_kernels().size() > 1) usable.push_back(&avx2_child_kernels());
  if (usable_kernels().size() > 2) usable.push_back(&avx512_child_kernels());
  return usable;
}

// One by one, with the library's functions.
Affine3d placed_alone(const Joints& joints, double part, double around, double away, double bend) {
  StemPiece piece;
  piece.nodes = {joints.a, joints.b};
  static const WeberPennParameters p = parameters_of("");
  const Stem stem(p, trunk_of(p, 1));
  Affine3d frame = joints.a.frame;
  lead_to(frame, stem.tangent(piece, 0, part));
  frame.origin = stem.position(piece, 0, part);
  turn_about_z(frame, around);
  turn_about_x(frame, away);
  const Vec3d o = frame.origin, n = frame.y;
  turn_about_up(frame, bend * std::atan2(n.z * o.x - n.x * o.z, n.x * o.x + n.z * o.z));
  const double tilt = declination(frame.y);
  turn_about_x(frame, frame.z.y < 0 ? -bend * tilt : bend * tilt);
  return frame;
}

TEST(ChildKernels, PlaceChildrenAsFramesTurnedOneByOne) {
  for (Key key = 0; key < 20; ++key) {
    const Joints joints = joints_of(key);
    ChildRows children = children_of(21);
    place(best_child_kernels(), joints, 0, children);
    for (std::size_t i = 0; i < children.size(); ++i) {
      const Affine3d frame = children.frame(i);
      const Affine3d expected = placed_alone(joints, children.at(ChildRows::part, i), children.at(ChildRows::around, i),
                                             children.at(ChildRows::away, i), 0.3);
      EXPECT_LT(length(frame.x - expected.x), 1e-10);
      EXPECT_LT(length(frame.y - expected.y), 1e-10);
      EXPECT_LT(length(frame.z - expected.z), 1e-10);
      EXPECT_EQ(frame.origin, expected.origin);
    }
  }
}

TEST(ChildKernels, HaveTheSameBitsWithEveryInstructionSetAndAtEveryPlace) {
  const Joints joints = joints_of(5);
  ChildRows expected = children_of(21);
  place(baseline_child_kernels(), joints, 0, expected);
  for (const ChildKernels* kernels : usable_child_kernels())
    for (std::size_t shift : {0, 1, 3, 8}) {
      ChildRows children = children_of(21, shift);
      place(*kernels, joints, shift, children);
      for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(children.frame(i + shift), expected.frame(i));
    }
}

TEST(ChildKernels, PutVerticesOfLeavesIntoTheirFramesOnTheGrid) {
  const Quantum quantum(0x1p-36);
  const std::vector<Vec3d> vertices{{0, 0, 0}, {0.3, 0.5, 0.1}, {-0.1, 1, 0}};
  ChildRows leaves = children_of(8);
  place(best_child_kernels(), joints_of(2), 0, leaves);
  for (const ChildKernels* kernels : usable_child_kernels()) {
    std::vector<double> placed(3 * vertices.size() * ChildRows::group);
    kernels->put_vertices(leaves.view(), 0, {vertices.data(), vertices.size(), -0.2, quantum.magic()}, placed.data());
    for (std::size_t i = 0; i < leaves.size(); ++i)
      for (std::size_t k = 0; k < vertices.size(); ++k) {
        const Affine3d f = leaves.frame(i);
        const Vec3d v = vertices[k];
        const Vec3d expected = quantum.round(f.origin + f.z * -0.2 + (f.z * v.y + f.y * v.z - f.x * v.x));
        const double* const p = &placed[3 * k * ChildRows::group + i];
        EXPECT_EQ((Vec3d{p[0], p[ChildRows::group], p[2 * ChildRows::group]}), expected);
      }
  }
}

}  // namespace
}  // namespace meristem::test
