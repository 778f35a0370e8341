// What holds for every template, and what is particular to each but the fork.
#include "tests/procedural/growth/derivation.h"

#include <gtest/gtest.h>

namespace meristem::test {
namespace {

Mesh grown_on(const std::string& base, const std::string& rule) {
  const Derivation d(base, {R"json({ "grow": 1, "rules": { "x": )json" + rule + "} }"});
  EXPECT_EQ(d.messages(), std::vector<std::string>{});
  return d.grown();
}

const std::string hexagon = R"json({ "type": "prism", "sides": 6, "radius": 1, "height": 1, "cap": "x" })json";
const std::string cube = R"json({ "type": "box", "size": [2, 1, 2], "top": "x" })json";

// A template with its defaults; a pyramid for "mesh", which has none.
BoundTemplate with_defaults(const std::string& name, Diagnostics& diagnostics) {
  const Value value = JsonText(name == "mesh" ? R"json({ "vertices": [[0,0,0],[0,1,0],[1,1,0],[1,0,0],[0.5,0.5,1]],
    "polygons": [[0,1,2,3],[1,0,4],[2,1,4],[3,2,4],[0,3,4]] })json"
                                              : "{}")
                          .read();
  Params params(value, name, diagnostics);
  return templates().create(name, params, rule_variables({}), {});
}

// Walks the registry: a new template is tested on arrival. All are closed but the leaf, whose blade has one border.
TEST(Templates, WithItsSocketEveryTemplateIsAManifold) {
  for (const std::string& name : templates().names())
    for (std::uint32_t n = 3; n <= 12; ++n) {
      Diagnostics diagnostics;
      const BoundTemplate part = with_defaults(name, diagnostics);
      ASSERT_TRUE(diagnostics.list().empty()) << name;
      if (!part.shape->refusal(n).empty()) continue;
      const NamedFaces faces = sample_growth(part, n);
      Mesh mesh = bare_mesh(faces, std::vector<Vec3d>(n));
      std::vector<std::uint32_t> socket(n);
      for (std::uint32_t i = 0; i < n; ++i) socket[i] = n - 1 - i;
      mesh.add_face(socket, ~Key(0), 0);
      EXPECT_EQ(manifold_defect(mesh), "") << name << " on " << n;
      EXPECT_EQ(is_closed(mesh), name != "leaf") << name << " on " << n;
      EXPECT_EQ(euler_characteristic(mesh), name == "leaf" ? 1 : 2) << name << " on " << n;
      for (int face_name : faces.names) EXPECT_LT(std::size_t(face_name), part.shape->face_names().size());
    }
}

TEST(Segment, CapIsTheFaceCarriedAlong) {
  const Derivation d(
      hexagon,
      {R"json({ "grow": 1, "rules": { "x": { "template": "segment", "length": 2, "taper": 0.5, "twist": 30, "faces": {
    "cap": "y" } } } })json"});
  const FaceFrame before = face_frame(d.base, faces_with(d.base, d.symbols->find("x"))[0]);
  const Mesh mesh = d.grown();
  const FaceFrame after = face_frame(mesh, faces_with(mesh, d.symbols->find("y"))[0]);
  EXPECT_NEAR(length(after.origin - before.origin - before.z * 2), 0, 1e-8);
  EXPECT_NEAR(after.radius, 0.5 * before.radius, 1e-8);
  EXPECT_NEAR(dot(after.z, before.z), 1, 1e-8);
  EXPECT_NEAR(dot(after.x, before.x), std::cos(pi / 6), 1e-8);
  EXPECT_NEAR(dot(after.x, before.y), std::sin(pi / 6), 1e-8);  // counter-clockwise
}

TEST(Segment, BendLeansTowardsItsDirection) {
  const Derivation d(
      hexagon,
      {R"json({ "grow": 1, "rules": { "x": { "template": "segment", "bend": 40, "bend_direction": 90, "faces": {
    "cap": "y" } } } })json"});
  const FaceFrame before = face_frame(d.base, faces_with(d.base, d.symbols->find("x"))[0]);
  const Mesh mesh = d.grown();
  const FaceFrame after = face_frame(mesh, faces_with(mesh, d.symbols->find("y"))[0]);
  const double a = 40 * pi / 180;
  EXPECT_NEAR(length(after.z - before.z * std::cos(a) - before.y * std::sin(a)), 0, 1e-8);
  EXPECT_NEAR(length(after.x - before.x), 0, 1e-8);
  EXPECT_NEAR(length(after.origin - before.origin), 1, 1e-8);
  EXPECT_NEAR(dot(normalize(after.origin - before.origin), before.z), std::cos(a / 2), 1e-8);
}

TEST(Segment, TropismTurnsTowardsTheWorldDirectionButNotBeyond) {
  const auto angle_to_x = [](const char* strength) {
    const Derivation d(
        hexagon, {fmt::format(
                     R"json({{ "grow": 1, "rules": {{ "x": {{ "template": "segment", "tropism": {}, "toward": [2, 0, 0],
    "faces": {{ "cap": "y" }} }} }} }})json",
                     strength)});
    const Mesh mesh = d.grown();
    return std::acos(face_frame(mesh, faces_with(mesh, d.symbols->find("y"))[0]).z.x);
  };
  EXPECT_NEAR(angle_to_x("0"), pi / 2, 1e-8);
  EXPECT_NEAR(angle_to_x("0.3"), pi / 2 - 0.3, 1e-6);  // the sine of the angle between is 1
  EXPECT_NEAR(angle_to_x("-0.3"), pi / 2 + 0.3, 1e-6);
  EXPECT_NEAR(angle_to_x("9"), 0, 1e-6);
}

TEST(Segment, UFollowsTheCornersAndVTheLength) {
  const Derivation d(octagon,
                     {R"json({ "grow": 1, "rules": { "shoot(l)": { "template": "segment", "length": 3, "faces": {
    "cap": "y" } } } })json"});
  const Mesh mesh = d.grown();
  const std::uint32_t cap = faces_with(mesh, d.symbols->find("y"))[0];
  const double u[] = {0, .5, 1, .5, 0, .5, 1, .5};
  for (std::uint32_t i = 0; i < 8; ++i) EXPECT_EQ(mesh.corner_uv[mesh.face_starts[cap] + i], (Vec2d{u[i], 4}));
  for (std::uint32_t c = 0; c < mesh.corner_vertices.size(); ++c)  // of this upright stem
    EXPECT_NEAR(mesh.corner_uv[c].y, mesh.positions[mesh.corner_vertices[c]].y, 1e-8);
}

TEST(Box, NamesEachSideAndTheGroupForTheRest) {
  const Derivation d(
      cube, {R"json({ "grow": 1, "rules": { "x": { "template": "box", "height": 2, "faces": { "front": "f", "side": "s",
    "top": "t" } } } })json"});
  const FaceFrame before = face_frame(d.base, faces_with(d.base, d.symbols->find("x"))[0]);
  const Mesh mesh = d.grown();
  EXPECT_EQ(faces_with(mesh, d.symbols->find("s")).size(), 3u);
  const auto front = faces_with(mesh, d.symbols->find("f"));
  ASSERT_EQ(front.size(), 1u);
  EXPECT_NEAR(length(face_frame(mesh, front[0]).z - before.x), 0, 1e-8);  // on the reference edge
  EXPECT_NEAR(face_frame(mesh, faces_with(mesh, d.symbols->find("t"))[0]).origin.y, 3, 1e-8);
}

TEST(Tent, SlopesMeetInARidge) {
  const Mesh mesh = grown_on(cube, R"json({ "template": "tent", "height": 3, "ridge": 0.5 })json");
  std::vector<Vec3d> ridge;
  for (Vec3d p : mesh.positions)
    if (p.y > 1.5) ridge.push_back(p);
  ASSERT_EQ(ridge.size(), 2u);
  EXPECT_NEAR(length(ridge[0] - ridge[1]), 1, 1e-8);
  EXPECT_NEAR(length((ridge[0] + ridge[1]) * 0.5 - Vec3d{0, 4, 0}), 0, 1e-8);
}

TEST(Spike, EndsInOneTip) {
  const Mesh mesh = grown_on(hexagon, R"json({ "template": "spike", "length": 2, "inset": 0.25 })json");
  int tips = 0, foot = 0;
  for (Vec3d p : mesh.positions) {
    tips += std::abs(p.y - 3) < 1e-8;
    foot += std::abs(p.y - 1) < 1e-8 && std::abs(length(Vec3d{p.x, 0, p.z}) - 0.75) < 1e-8;
  }
  EXPECT_EQ(tips, 1);
  EXPECT_EQ(foot, 6);
}

TEST(Extrude, DrawsInAndPushesIn) {
  const Derivation d(
      hexagon, {R"json({ "grow": 1, "rules": { "x": { "template": "extrude", "inset": 0.25, "height": -0.5, "taper": 2,
    "faces": { "cap": "y" } } } })json"});
  const Mesh mesh = d.grown();
  const FaceFrame cap = face_frame(mesh, faces_with(mesh, d.symbols->find("y"))[0]);
  EXPECT_NEAR(cap.origin.y, 0.5, 1e-8);
  EXPECT_NEAR(cap.radius, 1.5, 1e-8);
  EXPECT_NEAR(cap.z.y, 1, 1e-8);
}

// On a plane that looks up, and whose frame has x along -z: the leaf rises along y, its upper side sees +z.
struct LeafOnAPlane {
  Derivation d;
  Mesh mesh = d.grown();
  explicit LeafOnAPlane(const std::string& parameters)
      : d(R"json({ "type": "plane", "face": "x" })json",
          {R"json({ "grow": 1, "rules": { "x": { "template": "leaf", "length": 2, "width": 1, "stalk": 0.5,
    "sections": 3, "widest": 0.5, "faces": { "blade": "blade" }, )json" +
           parameters + "} } }"}) {
    EXPECT_EQ(d.messages(), std::vector<std::string>{});
  }
  Bounds3d box() const {
    Bounds3d b;
    for (Vec3d p : mesh.positions) b.extend(p);
    return b;
  }
};

TEST(Leaf, StalksAreAFiftiethOfTheWidthUnlessTheirRadiusIsGiven) {
  const LeafOnAPlane thin(R"json("bend": 10)json"), spelt_out(R"json("bend": 10, "stalk_radius": 0.02)json"),
      thick(R"json("bend": 10, "stalk_radius": 0.1)json");
  double to_spelt_out = 0, to_thick = 0;
  for (std::size_t i = 0; i < thin.mesh.positions.size(); ++i) {
    to_spelt_out = std::max(to_spelt_out, length(thin.mesh.positions[i] - spelt_out.mesh.positions[i]));
    to_thick = std::max(to_thick, length(thin.mesh.positions[i] - thick.mesh.positions[i]));
  }
  EXPECT_LT(to_spelt_out, 1e-8);
  EXPECT_NEAR(to_thick, 0.08, 1e-6);
}

TEST(Leaf, IsAsLongAndAsWideAsItSays) {
  const Bounds3d box = LeafOnAPlane(R"json("bend": 0, "fold": 0, "droop": 0)json").box();
  EXPECT_NEAR(box.upper.y, 2.5, 1e-8);
  const LeafOnAPlane leaf(R"json("bend": 0, "fold": 0, "droop": 0)json");
  double widest = 0;
  for (Vec3d p : leaf.mesh.positions)
    if (std::abs(p.y - 1.5) < 1e-8) widest = std::max(widest, 2 * std::abs(p.x));
  EXPECT_NEAR(widest, 1, 1e-8);
}

TEST(Leaf, UpperSideLooksAwayFromTheReferenceEdge) {
  const LeafOnAPlane leaf(R"json("bend": 0, "fold": 0, "droop": 0)json");
  const FaceFrame socket = face_frame(leaf.d.base, 0);
  const auto blade = faces_with(leaf.mesh, leaf.d.symbols->find("blade"));
  EXPECT_EQ(blade.size(), 2u * 4);  // between the stalk, three sections and the tip
  for (const std::uint32_t f : blade) EXPECT_LT(dot(face_frame(leaf.mesh, f).z, socket.x), -0.99);
}

TEST(Leaf, DroopsAlongAnArcOfItsLength) {
  // A quarter of a circle: as far down as along
  const LeafOnAPlane leaf(R"json("bend": 0, "fold": 0, "droop": 90)json");
  const FaceFrame socket = face_frame(leaf.d.base, 0);
  const double radius = 2 / (pi / 2);
  double nearest = 1;
  for (Vec3d p : leaf.mesh.positions)
    nearest = std::min(nearest, length(p - (Vec3d{0, 0.5 + radius, 0} + socket.x * radius)));
  EXPECT_LT(nearest, 1e-8);
}

TEST(Leaf, TurnsItsUpperSideToTheLight) {
  const LeafOnAPlane leaf(R"json("bend": 0, "fold": 0, "droop": 0, "facing": 1, "toward": [3, 5, 4])json");
  for (const std::uint32_t f : faces_with(leaf.mesh, leaf.d.symbols->find("blade")))
    EXPECT_GT(dot(face_frame(leaf.mesh, f).z, Vec3d(0.6, 0, 0.8)), 0.99);
}

TEST(Leaf, FoldRaisesTheRimsAndLeavesTheMidrib) {
  const LeafOnAPlane leaf(R"json("bend": 0, "fold": 30, "droop": 0)json");
  const FaceFrame socket = face_frame(leaf.d.base, 0);
  double highest = 0;
  for (Vec3d p : leaf.mesh.positions)
    if (std::abs(p.y - 1.5) < 1e-8) highest = std::max(highest, -dot(p, socket.x));
  EXPECT_NEAR(highest, 0.5 * std::sin(pi / 6), 1e-8);
}

// A box of sides 2, 2, 1 as a template, its bottom the socket: on the unit-radius quadrilateral it must be the box
// again.
TEST(MeshTemplate, LiesOnTheSocketByItsReferenceEdge) {
  const std::string rule =
      R"json({ "template": "mesh", "vertices": [[-1,-1,5],[1,-1,5],[1,1,5],[-1,1,5],[-1,-1,6],[1,-1,6],[1,1,6],
    [-1,1,7]],
    "polygons": [[0,3,2,1],[0,1,5,4],[1,2,6,5],[2,3,7,6],[3,0,4,7],[4,5,6,7]],
    "names": ["socket","s","s","s","s","top"], "faces": { "top": "y" } })json";
  const Derivation d(cube, {R"json({ "grow": 1, "rules": { "x": )json" + rule + "} }"});
  ASSERT_EQ(d.messages(), std::vector<std::string>{});
  const FaceFrame socket = face_frame(d.base, faces_with(d.base, d.symbols->find("x"))[0]);
  const Mesh mesh = d.grown();
  EXPECT_EQ(manifold_defect(mesh), "");
  EXPECT_TRUE(is_closed(mesh));
  const std::uint32_t top = faces_with(mesh, d.symbols->find("y"))[0];
  const auto corners = mesh.corners(top);
  // The first polygon's reference edge is 0 3, at x = -1, so -x there is the frame's x here, and y the frame's -y
  const Vec3d expected[] = {{1, 1, 1}, {-1, 1, 1}, {-1, -1, 1}, {1, -1, 2}};
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3d p = mesh.positions[corners[i]] - socket.origin;
    EXPECT_NEAR(dot(p, socket.x), expected[i].x, 1e-8);
    EXPECT_NEAR(dot(p, socket.y), expected[i].y, 1e-8);
    EXPECT_NEAR(dot(p, socket.z), expected[i].z, 1e-8);
  }
}

std::vector<std::string> errors_of_mesh(const std::string& data) {
  return Derivation(cube, {R"json({ "grow": 1, "rules": { "x": )json"
                           "\n"
                           R"json({ "template": "mesh", )json" +
                           data + "} } }"})
      .messages();
}

TEST(MeshTemplate, RejectsWhatCannotBeWelded) {
  const std::string tetrahedron = R"json("vertices": [[0,0,0],[1,0,0],[0,1,0],[0,0,1]], "polygons": )json";
  using Messages = std::vector<std::string>;
  EXPECT_EQ(errors_of_mesh(tetrahedron + "[[0,2,1],[0,1,3],[1,2,3],[0,3,2]]"), Messages{});
  EXPECT_EQ(errors_of_mesh(tetrahedron + "[[0,2,1],[0,1,3],[1,2,3]]"),
            (Messages{"2:1 a template mesh must be closed: every edge needs two polygons"}));
  EXPECT_EQ(errors_of_mesh(tetrahedron + "[[0,2,0],[0,1,3]]"),
            (Messages{"2:1 the mesh is not a manifold: face 0 has vertex 0 twice"}));
  EXPECT_EQ(errors_of_mesh(tetrahedron + "[[0,2,4]]").at(0),
            "2:83 expected the indices, 0 to 3, of 3 or more vertices");
  EXPECT_EQ(errors_of_mesh(R"json("file": "../secret.obj")json"),
            (Messages{"2:31 a mesh file must lie in the scene's folder or below it"}));
  EXPECT_EQ(errors_of_mesh(R"json("scale": 2)json"),
            (Messages{"2:1 a mesh needs a \"file\", or \"vertices\" and \"polygons\""}));
}

}  // namespace
}  // namespace meristem::test
