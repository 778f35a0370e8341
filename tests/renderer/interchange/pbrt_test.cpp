#include "renderer/interchange/pbrt_reader.h"

#include "renderer/image/image.h"
#include "renderer/interchange/blackbody.h"
#include "renderer/loading/load_scene.h"
#include "tests/renderer/interchange/folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace meristem {
namespace {

// The messages of reading a scene as "line:column message".
std::vector<std::string> messages(const std::string& text) {
  const Folder folder("pbrt");
  AssetFolder assets(folder.file("out.jsonc"));
  Diagnostics diagnostics;
  try {
    read_pbrt(folder.write("scene.pbrt", text), assets, diagnostics);
  } catch (const SceneErrors&) {}
  std::vector<std::string> list;
  for (const Diagnostic& d : diagnostics.list())
    list.push_back(std::to_string(d.location.line()) + ":" + std::to_string(d.location.column()) + " " + d.message);
  return list;
}

struct Converted {
  ForeignScene foreign;
  LoadedScene loaded;
};

Converted convert(const Folder& folder, const std::string& text) {
  AssetFolder assets(folder.file("out.jsonc"));
  Diagnostics diagnostics;
  Converted c{read_pbrt(folder.write("scene.pbrt", text), assets, diagnostics), {}};
  complete_foreign_scene(c.foreign, diagnostics);
  write_foreign_scene(c.foreign, folder.file("out.jsonc"), assets);
  LoadOptions options;
  options.check_only = true;
  c.loaded = load_scene(folder.file("out.jsonc"), options);
  return c;
}

// What the camera sees at a point of the image, 0 to 1 from the top left.
SurfaceHit seen(const LoadedScene& loaded, float x, float y) {
  const Scene& scene = *loaded.scene;
  const int w = scene.settings.width, h = scene.settings.height;
  SurfaceHit hit;
  scene.intersector->intersect(scene.camera->ray({{x * float(w), y * float(h)}, {0.5f, 0.5f}}, w, h), hit);
  return hit;
}

// A red triangle on the camera's right and a ball on its left: in pbrt's image x grows to the right of a camera that
// looks along z.
constexpr const char* left_and_right = R"(
  CAMERA
  Camera "perspective" "float fov" 60
  Film "rgb" "integer xresolution" [200] "integer yresolution" [100] "string filename" "a.exr"
  Sampler "zsobol" "integer pixelsamples" 32
  WorldBegin
  AttributeBegin  # in front of the camera, which stands in the origin
    Material "diffuse" "rgb reflectance" [ .7 .1 .1 ]
    Translate 2 0 0
    Shape "trianglemesh" "point3 P" [ -1 -1 5  1 -1 5  0 1 5 ] "integer indices" [ 0 1 2 ]
  AttributeEnd
  AttributeBegin
    Material "conductor" "spectrum eta" "metal-Au-eta" "spectrum k" "metal-Au-k" "float roughness" 0.0625
    Translate -2 0 5
    Scale .5 .5 .5
    Shape "sphere" "float radius" 2
  AttributeEnd
)";

TEST(Pbrt, ImagesAreNotMirrored) {
  for (const char* camera : {"LookAt 0 0 0  0 0 1  0 1 0", "Scale -1 1 1 LookAt 0 0 0  0 0 1  0 1 0"}) {
    const Folder folder("pbrt");
    std::string text = left_and_right;
    text.replace(text.find("CAMERA"), 6, camera);
    const bool flipped = camera[0] == 'S';
    const Converted c = convert(folder, text);
    const float right = flipped ? 0.327f : 0.673f;  // 2 to the side, 5 ahead
    const SurfaceHit triangle = seen(c.loaded, right, 0.5f), ball = seen(c.loaded, 1 - right, 0.5f);
    ASSERT_TRUE(triangle.valid()) << camera;
    ASSERT_TRUE(ball.valid()) << camera;
    EXPECT_NEAR(triangle.t, std::hypot(5, 2), 0.05);
    EXPECT_NEAR(ball.t, std::hypot(5, 2) - 1, 0.05);
    EXPECT_EQ(c.loaded.scene->names.materials[std::size_t(triangle.origin.material)], "material-1");
  }
}

TEST(Pbrt, SettingsAndMaterialsCarryOver) {
  const Folder folder("pbrt");
  std::string text = left_and_right;
  text.replace(text.find("CAMERA"), 6, "");
  const Converted c = convert(folder, text);
  const Scene& scene = *c.loaded.scene;
  EXPECT_EQ(scene.settings.width, 200);
  EXPECT_EQ(scene.settings.samples, 32);
  const Value& metal = c.foreign.materials[1].value;
  EXPECT_EQ(metal.find("base_metalness")->number, 1);
  EXPECT_EQ(metal.find("base_color")->text, "[1, 0.782, 0.344]");
  EXPECT_DOUBLE_EQ(metal.find("specular_roughness")->number, 0.5) << "alpha is the root there, the square here";
  EXPECT_DOUBLE_EQ(c.foreign.cameras[0].value.find("fov")->number, 60) << "of the shorter side";
}

// The shorter side shows from -1 to 1, in the camera's own units.
TEST(Pbrt, ACameraWithoutPerspective) {
  const Folder folder("pbrt");
  std::string text = left_and_right;
  text.replace(text.find("CAMERA"), 6, "Scale .25 .25 .25");
  const std::string perspective = R"("perspective" "float fov" 60)";
  text.replace(text.find(perspective), perspective.size(), R"("orthographic")");
  const Converted c = convert(folder, text);
  EXPECT_EQ(c.foreign.cameras[0].value.find("height")->number, 8);
  const SurfaceHit triangle = seen(c.loaded, 0.5f + 2.f / 16, 0.5f), ball = seen(c.loaded, 0.5f - 2.f / 16, 0.5f);
  ASSERT_TRUE(triangle.valid() && ball.valid());
  EXPECT_NEAR(triangle.t, 5, 1e-3);
  EXPECT_NEAR(ball.t, 4, 0.01);
  EXPECT_FALSE(seen(c.loaded, 0.5f + 3.2f / 16, 0.5f).valid());
}

TEST(Pbrt, InstancesShareWhatTheyShow) {
  const Folder folder("pbrt");
  folder.write("part.pbrt", R"(Shape "bilinearmesh" "point3 P" [ 0 0 0  1 0 0  0 1 0  1 1 0 ])");
  const Converted c = convert(folder, R"(
    LookAt 0 0 -9  0 0 0  0 1 0  Camera "perspective" "float fov" 40
    WorldBegin
    ObjectBegin "pair"
      Include "part.pbrt"
      Translate 0 3 0
      Shape "disk" "float radius" 0.5
    ObjectEnd
    ObjectInstance "pair"
    AttributeBegin
      Translate 10 0 0 ConcatTransform [ 2 0 0 0  0 2 0 0  0 0 2 0  0 0 0 1 ] ObjectInstance "pair"
    AttributeEnd
    LightSource "infinite" "rgb L" [ .1 .2 .3 ] "float scale" 2
    LightSource "distant" "point3 from" [ 0 1 0 ] "point3 to" [ 0 0 0 ] "blackbody L" 6500 "float illuminance" 3)");
  EXPECT_EQ(c.foreign.models.size(), 2u);
  EXPECT_EQ(c.foreign.groups.size(), 1u);
  EXPECT_EQ(c.foreign.objects.size(), 2u);
  EXPECT_EQ(c.foreign.lights.size(), 2u);
  EXPECT_DOUBLE_EQ(c.foreign.lights[0].find("color")->items[2].number, 0.6);
  const Bounds3f bounds = c.loaded.scene->intersector->bounds();
  EXPECT_NEAR(bounds.lower.x, -0.5, 1e-3);
  EXPECT_NEAR(bounds.upper.x, 12, 1e-3);
  EXPECT_NEAR(bounds.upper.y, 7, 1e-2);
}

// Two triangles of a smooth square; the vertices of its diagonal stand twice, with other coordinates.
TEST(Pbrt, SeamsOfTexturesStay) {
  const Folder folder("pbrt");
  const std::string square = R"("point3 P" [ 0 0 0  1 0 0  1 1 0  0 0 0  1 1 0  0 1 0 ]
      "point2 uv" [ 0 0  .5 0  0 1  1 0  1 1  .5 1 ] "integer indices" [ 0 1 2  3 4 5 ])";
  const Converted c = convert(folder, R"(
    Camera "perspective"
    WorldBegin
    Shape "trianglemesh" "normal N" [ 0 0 1  0 0 1  0 0 1  0 0 1  0 0 1  0 0 1 ] )" +
                                          square + R"(
    Shape "loopsubdiv" "integer levels" 1 )" +
                                          square);
  ASSERT_EQ(c.foreign.models.size(), 2u);
  const double u[] = {0, 0.5, 0, 1, 1, 0.5};
  for (const ForeignModel& model : c.foreign.models) {
    EXPECT_EQ(model.mesh->positions.size(), 4u) << "else subdivision would open it";
    ASSERT_EQ(model.mesh->corner_uv.size(), 6u);
    for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(model.mesh->uv[model.mesh->corner_uv[i]].x, u[i]) << i;
  }
}

TEST(Pbrt, TexturesBecomeExpressions) {
  const Folder folder("pbrt");
  write_image(folder.file("wood.png"), {2, 2, 3, std::vector<float>(12, 0.5f)});
  const Converted c = convert(folder, R"(
    Camera "perspective"
    WorldBegin
    Texture "wood" "spectrum" "imagemap" "string filename" "wood.png" "float uscale" 3 "string wrap" "clamp"
    Texture "dark" "spectrum" "scale" "texture tex" "wood" "float scale" 0.5
    Texture "tiles" "spectrum" "checkerboard" "rgb tex1" [ 1 0 0 ] "texture tex2" "dark" "float uscale" 4
    MakeNamedMaterial "tiled" "string type" "coateddiffuse" "texture reflectance" "tiles" "float eta" 1.4
    MakeNamedMaterial "leaf" "string type" "diffusetransmission" "rgb reflectance" [.1 .2 .1]
      "rgb transmittance" [.1 .2 .1]
    NamedMaterial "tiled"
    Shape "trianglemesh" "point3 P" [ 0 0 5  1 0 5  0 1 5 ] "point2 uv" [ 0 0 1 0 0 1 ]
    NamedMaterial "leaf"
    Shape "loopsubdiv" "integer levels" 2 "point3 P" [ 0 0 6  1 0 6  0 1 6 ] "integer indices" [ 0 1 2 ]
    AreaLightSource "diffuse" "rgb L" [ 3 2 1 ] "bool twosided" true
    Shape "sphere" "float radius" 0.25
    Shape "disk")");
  const Value& tiled = c.foreign.materials[0].value;
  EXPECT_EQ(tiled.find("textures")->members.size(), 1u);
  EXPECT_TRUE(std::filesystem::exists(folder.file("out-files/wood.png")));
  EXPECT_EQ(c.foreign.lights.size(), 1u) << "a glowing ball is a light";
  EXPECT_EQ(c.foreign.models.size(), 3u);
  EXPECT_NE(c.foreign.models[2].material.find("glowing"), std::string::npos);
  EXPECT_EQ(c.loaded.warnings.size(), 0u);
  EXPECT_GT(c.loaded.scene->lights.size(), 1u) << "the triangles of the disk";
}

TEST(Pbrt, WhatIsLeftOutIsListed) {
  const auto list = messages(R"(Option "string seed" "1"
Camera "perspective" "float shutteropen" 0
WorldBegin
LightSource "spot" "rgb I" [ 1 1 1 ]
Material "hair" "float beta_m" 0.3
Shape "curve" "point3 P" [ 0 0 0 1 1 1 2 2 2 3 3 3 ]
Shape "trianglemesh" "point3 P" [ 0 0 0  1 0 0  2 0 0 ] "string alpha" "x"
)");
  const std::vector<std::string> expected{"1:1 Option was left out",
                                          "2:22 \"shutteropen\" was left out",
                                          "4:1 the light \"spot\" was left out",
                                          "4:20 \"I\" was left out",
                                          "5:1 the material \"hair\" became grey",
                                          "5:17 \"beta_m\" was left out",
                                          "6:1 the shape \"curve\" was left out",
                                          "6:15 \"P\" was left out",
                                          "7:1 1 faces without area were left out",
                                          "7:1 a mesh without faces was left out",
                                          "7:57 \"alpha\" was left out"};
  EXPECT_EQ(list, expected);
}

TEST(Pbrt, ErrorsSayWhere) {
  const auto first = [](const std::string& text) {
    const auto list = messages(text);
    return list.empty() ? "" : list[0];
  };
  EXPECT_EQ(first("WorldBegun\n"), "1:1 \"WorldBegun\" is no statement of pbrt-v4 that is read here");
  EXPECT_EQ(first("Translate 1 x 3\n"), "1:13 expected a number");
  EXPECT_EQ(first("\n Scale 1 1 1e999\n"), "2:12 expected a number");
  EXPECT_EQ(first("AttributeEnd\n"), "1:1 this ends what has not begun");
  EXPECT_EQ(first("Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ] \"integer indices\" [ 0 1 3 ]"),
            "1:55 there is no vertex 3; there are 3, from 0 on");
  EXPECT_EQ(first("Shape \"trianglemesh\" \"point3 P\" [ 0 0"), "1:22 the list of values has no closing bracket");
  EXPECT_EQ(first("NamedMaterial \"gold\""), "1:1 there is no material named \"gold\" before this");
  EXPECT_EQ(first("Include \"../other.pbrt\""), "1:1 \"../other.pbrt\" leaves the folder of the scene");
  const std::string texture = "Texture \"bark\" \"spectrum\" \"imagemap\" ";
  EXPECT_EQ(first(texture + "\"string filename\" \"../bark.png\""),
            "1:38 the image \"../bark.png\" leaves the folder of the scene");
  const std::string missing = first(texture + "\"string filename\" \"bark.png\"");
  EXPECT_TRUE(missing.starts_with("1:38 cannot read ")) << missing;
  EXPECT_NE(missing.find("bark.png"), missing.npos) << missing;
  EXPECT_EQ(first("Include \"scene.pbrt\""), "1:1 \"scene.pbrt\" includes itself");
  EXPECT_EQ(first("LookAt 0 0 0  0 1 0  0 1 0"), "1:1 LookAt looks along its own up");
  EXPECT_EQ(first("Camera \"perspective"), "1:8 the text has no closing quote");
  EXPECT_EQ(first("Transform [ 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 1 ]"), "1:1 the transform cannot be inverted");
}

TEST(Pbrt, BrokenFilesEnd) {
  std::string text = left_and_right;
  text.replace(text.find("CAMERA"), 6, "LookAt 0 0 0 0 0 1 0 1 0");
  for (std::size_t size = 0; size < text.size(); size += 3) messages(text.substr(0, size));
  for (std::size_t at = 0; at < text.size(); at += 2) {
    std::string spoilt = text;
    spoilt[at] = "\"[]x9-# "[at / 2 % 8];
    messages(spoilt);
  }
}

TEST(Pbrt, BlackBodiesHaveTheirColours) {
  const Vec3d warm = blackbody_color(2856), day = blackbody_color(6504);
  EXPECT_NEAR(dot(warm, Vec3d{0.2126, 0.7152, 0.0722}), 1, 2e-3);
  EXPECT_NEAR(warm.x, 1.83, 0.03);  // CIE illuminant A in Rec.709
  EXPECT_NEAR(warm.z, 0.23, 0.03);
  EXPECT_NEAR(day.x, 1, 0.06);
  EXPECT_NEAR(day.z, 1, 0.06);
}

}  // namespace
}  // namespace meristem
