#include "tests/procedural/growth/derivation.h"

#include "procedural/growth/turning.h"

#include <gtest/gtest.h>

#include <numeric>

namespace meristem::test {
namespace {

// An octagonal stem of radius 0.25 up to height 1 with a fork on it; caps are "left" and "right", sides "side".
struct Forked {
  Derivation derivation;
  Mesh mesh;
  FaceFrame stem;
  explicit Forked(const std::string& options = {}, const std::string& base = octagon)
      : derivation(base, {R"json({ "grow": 1, "rules": { "shoot(l)": { "template": "fork", )json" + options +
                          R"json( "faces": { "left": "left", "right": "right", "side": "side" } } } })json"}),
        mesh(derivation.grown()),
        stem(face_frame(derivation.base, faces("shoot", derivation.base).at(0))) {
    EXPECT_EQ(derivation.messages(), std::vector<std::string>{});
    EXPECT_EQ(manifold_defect(mesh), "");
    EXPECT_TRUE(is_closed(mesh));
    EXPECT_EQ(euler_characteristic(mesh), 2);
  }
  std::vector<std::uint32_t> faces(const char* symbol, const Mesh& m) const {
    return faces_with(m, derivation.symbols->find(symbol));
  }
  std::uint32_t cap(const char* symbol) const { return faces(symbol, mesh).at(0); }
  FaceFrame frame(const char* symbol) const { return face_frame(mesh, cap(symbol)); }

  // The u that the faces around a vertex give to it.
  std::multiset<double> u_of(std::uint32_t vertex) const {
    std::multiset<double> values;
    for (std::size_t c = 0; c < mesh.corner_vertices.size(); ++c)
      if (mesh.corner_vertices[c] == vertex) values.insert(mesh.corner_uv[c].x);
    return values;
  }
  // The averages of u where faces disagree, ascending.
  std::vector<double> averaged_u() const {
    std::vector<double> result;
    for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
      const std::multiset<double> values = u_of(v);
      if (*values.begin() != *values.rbegin())
        result.push_back(std::accumulate(values.begin(), values.end(), 0.0) / double(values.size()));
    }
    std::sort(result.begin(), result.end());
    return result;
  }
  std::vector<double> cap_u(const char* symbol) const {
    const auto first = mesh.corner_uv.begin() + mesh.face_starts[cap(symbol)];
    std::vector<double> result;
    for (auto uv = first; uv != first + 8; ++uv) result.push_back(uv->x);
    return result;
  }
};

const std::vector<double> two_mirrored_cycles{0, .5, 1, .5, 0, .5, 1, .5};

// Figure 9: the stem starts with two mirrored cycles of u and each branch ends with two.
TEST(Fork, EachBranchHasTheTwoMirroredCyclesOfTheStem) {
  for (const char* options :
       {"", R"json("split": 1,)json", R"json("halve": "edges",)json", R"json("split": 3, "halve": "edges",)json"}) {
    const Forked fork(options);
    EXPECT_EQ(fork.cap_u("left"), two_mirrored_cycles) << options;
    EXPECT_EQ(fork.cap_u("right"), two_mirrored_cycles) << options;
  }
}

TEST(Fork, TheLineChosenByItselfLeavesNoConflictOfU) { EXPECT_EQ(Forked().averaged_u(), std::vector<double>{}); }

TEST(Fork, HalvedAtCornersWithoutMirrorSymmetryTwoVerticesAreAveraged) {
  EXPECT_EQ(Forked(R"json("split": 1,)json").averaged_u(), (std::vector<double>{.5, .5}));
}

// Figure 9: u1 = (0 + .5)/2 and u2 = (.5 + 1)/2.
TEST(Fork, HalvedAtEdgesUIsAveragedAsInThePaper) {
  EXPECT_EQ(Forked(R"json("halve": "edges",)json").averaged_u(), (std::vector<double>{.25, .25, .75, .75}));
}

TEST(Fork, OldVerticesKeepTheirU) {
  for (const char* options : {"", R"json("split": 1,)json", R"json("halve": "edges",)json"}) {
    const Forked fork(options);
    const std::uint32_t cap = fork.faces("shoot", fork.derivation.base).at(0);
    for (std::uint32_t i = 0; i < 8; ++i) {
      const std::uint32_t old = fork.derivation.base.corners(cap)[i];
      const auto now =
          std::find(fork.mesh.vertex_keys.begin(), fork.mesh.vertex_keys.end(), fork.derivation.base.vertex_keys[old]);
      for (double u : fork.u_of(std::uint32_t(now - fork.mesh.vertex_keys.begin())))
        EXPECT_EQ(u, two_mirrored_cycles[i]);
    }
  }
}

TEST(Fork, HalvedAtCornersIsAllQuadrilaterals) {
  const Forked fork;
  EXPECT_EQ(fork.faces("side", fork.mesh).size(), 16u);
  std::map<std::uint32_t, int> edges;  // by vertex
  for (std::uint32_t f = 0; f < fork.mesh.face_count(); ++f) {
    const auto corners = fork.mesh.corners(f);
    EXPECT_TRUE(corners.size() == 4 || corners.size() == 8);
    for (std::uint32_t v : corners) ++edges[v];
  }
  int irregular = 0;
  for (const auto& [vertex, count] : edges)
    if (count > 4) {
      ++irregular;
      EXPECT_EQ(count, 6);
    }
  EXPECT_EQ(irregular, 2);
}

// The frame of a cap is the stem's frame leant outwards by its share of the angle: no roll.
TEST(Fork, CapsAreTheStemTurnedOutwards) {
  const Forked fork(R"json("angle": 50, "balance": 0.3, "left_radius": 0.8, "right_radius": 0.6,)json");
  const auto check = [&](const char* branch, double angle, double radius, double side) {
    const FaceFrame frame = fork.frame(branch);
    const Vec3d outwards = normalize(frame.z - fork.stem.z * dot(frame.z, fork.stem.z));
    EXPECT_NEAR(dot(frame.z, fork.stem.z), std::cos(radians(angle)), 1e-8) << branch;
    EXPECT_NEAR(frame.radius, 0.25 * radius, 1e-8) << branch;
    const Affine3d turn = lean(fork.stem, outwards, radians(angle));
    EXPECT_NEAR(length(turn.vector(fork.stem.x) - frame.x), 0, 1e-7) << branch;
    EXPECT_NEAR(length(turn.vector(fork.stem.y) - frame.y), 0, 1e-7) << branch;
    EXPECT_GT(dot(frame.origin - fork.stem.origin, outwards), 0) << branch;
    return outwards * side;
  };
  const Vec3d left = check("left", 15, 0.8, 1), right = check("right", 35, 0.6, -1);
  EXPECT_NEAR(length(left - right), 0, 1e-7);  // opposite sides of one plane
}

// Two mirrored cycles leave four lines without conflict, at right angles to each other; the corners lie at odd
// multiples of 22.5 degrees from the reference edge.
TEST(Fork, RollPicksTheNearestLineThatSuitsU) {
  for (const int roll : {0, 60, 90, 170, 260, -40}) {
    const Forked fork(fmt::format(R"json("roll": {},)json", roll));
    const FaceFrame left = fork.frame("left");
    const double angle = std::atan2(dot(left.z, fork.stem.y), dot(left.z, fork.stem.x)) * 180 / pi;
    EXPECT_LE(std::abs(std::remainder(angle - roll, 360)), 45 + 1e-6) << roll;
    EXPECT_EQ(fork.averaged_u(), std::vector<double>{});
  }
}

TEST(Fork, CapsDoNotTouchHoweverShortTheBranches) {
  for (const double length_of : {0.01, 0.1, 1.0})
    for (const int angle : {0, 30, 90}) {
      const Forked fork(
          fmt::format(R"json("length": {}, "angle": {}, "left_radius": 1, "right_radius": 1,)json", length_of, angle));
      const Vec3d apart = normalize(fork.frame("left").origin - fork.frame("right").origin);
      double left = INFINITY, right = -INFINITY;
      for (std::uint32_t v : fork.mesh.corners(fork.cap("left")))
        left = std::min(left, dot(fork.mesh.positions[v], apart));
      for (std::uint32_t v : fork.mesh.corners(fork.cap("right")))
        right = std::max(right, dot(fork.mesh.positions[v], apart));
      EXPECT_GT(left, right) << length_of << " " << angle;
    }
}

TEST(Fork, SaddleRisesBetweenTheBranches) {
  const Forked fork(R"json("length": 2, "saddle": 0.3,)json");
  double saddle = 0;  // the highest new vertex on the stem's axis
  for (Vec3d p : fork.mesh.positions)
    if (std::abs(p.x) + std::abs(p.z) < 1e-6) saddle = p.y;
  EXPECT_NEAR(saddle, 1.6, 1e-6);
}

}  // namespace
}  // namespace meristem::test
