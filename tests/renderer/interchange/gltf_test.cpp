#include "renderer/interchange/gltf_reader.h"

#include "geometry/base/key.h"
#include "geometry/fields/expression.h"
#include "renderer/interchange/export_scene.h"
#include "renderer/interchange/foreign_mesh.h"
#include "renderer/interchange/material_looks.h"
#include "renderer/interchange/vertex_colors.h"
#include "tests/renderer/interchange/folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <sstream>

namespace meristem {
namespace {

ForeignScene read(const std::string& path, std::vector<std::string>* messages = nullptr) {
  AssetFolder assets(path + ".jsonc");
  Diagnostics diagnostics;
  ForeignScene scene;
  try {
    scene = read_gltf(path, assets, diagnostics);
  } catch (const SceneErrors&) {
    EXPECT_TRUE(messages) << "errors";
  }
  for (const Diagnostic& d : diagnostics.list()) {
    if (messages)
      messages->push_back(std::to_string(d.location.line()) + ":" + std::to_string(d.location.column()) + " " +
                          d.message);
    else
      ADD_FAILURE() << d.formatted();
  }
  return scene;
}

LoadedScene load(const std::string& path, bool keep_objects) {
  LoadOptions options;
  options.check_only = true;
  options.keep_objects = keep_objects;
  return load_scene(path, options);
}

constexpr const char* two_boxes = R"({
  "materials": { "red": { "base_color": [0.5, 0.1, 0.1], "specular_roughness": 0.6 },
                 "gold": { "base_color": [1, 0.8, 0.3], "base_metalness": 1 },
                 "lacquer": { "specular_ior": 1.45, "coat_weight": 0.75, "coat_roughness": 0.25 } },
  "models": { "box": { "base": { "type": "box" }, "material": "red" },
              "ball": { "base": { "type": "sphere" }, "material": "gold", "steps": [ { "subdivide": 3 } ] } },
  "objects": [ { "model": "box" }, { "model": "box", "position": [3, 0, 0], "rotate": [0, 45, 0], "scale": [1, 2, -1] },
               { "model": "ball", "position": [0, 2, 0] } ],
  "lights": [ { "type": "constant" } ],
  "camera": { "from": [1, 2, 8], "to": [1, 1, 0], "fov": 35 },
  "render": { "size": [320, 160], "detail": 0 } })";

std::string exported(const Folder& folder) {
  const LoadedScene scene = load(folder.write("scene.jsonc", two_boxes), true);
  export_scene(scene, *make_mesh_writer(folder.file("mesh.glb"), false, scene.scene->names.materials),
               [](double, std::uint64_t) {});
  return folder.file("mesh.glb");
}

// What is exported and read again is the same scene.
TEST(Gltf, RoundTrip) {
  const Folder folder("gltf");
  const std::string path = exported(folder);
  AssetFolder assets(folder.file("again.jsonc"));
  Diagnostics diagnostics;
  ForeignScene foreign = read_gltf(path, assets, diagnostics);
  complete_foreign_scene(foreign, diagnostics);
  write_foreign_scene(foreign, folder.file("again.jsonc"), assets);
  EXPECT_EQ(foreign.models.size(), 2u);
  EXPECT_EQ(foreign.objects.size(), 3u);
  const LoadedScene before = load(folder.file("scene.jsonc"), false), after = load(folder.file("again.jsonc"), false);
  EXPECT_EQ(after.scene->settings.width, 1440);
  const auto seen = [](const LoadedScene& loaded, float x, float y) {
    SurfaceHit hit;
    loaded.scene->intersector->intersect(loaded.scene->camera->ray({{x, y}, {0.5f, 0.5f}}, 320, 160), hit);
    return hit;
  };
  const auto name = [](const LoadedScene& loaded, const SurfaceHit& hit) {
    return loaded.scene->names.materials[std::size_t(hit.origin.material)];
  };
  int hits = 0;
  for (float y = 2; y < 160; y += 12)
    for (float x = 2; x < 320; x += 12) {
      const SurfaceHit a = seen(before, x, y), b = seen(after, x, y);
      ASSERT_EQ(a.valid(), b.valid()) << x << ", " << y;
      if (!a.valid()) continue;
      ++hits;
      EXPECT_NEAR(a.t, b.t, 1e-3);
      EXPECT_EQ(name(before, a), name(after, b));
      EXPECT_GT(dot(a.geometric_normal, b.geometric_normal), 0.99f);
    }
  EXPECT_GT(hits, 30);
  const Value& gold = foreign.materials[2].value;
  EXPECT_EQ(gold.find("base_metalness")->text, "1");
  EXPECT_EQ(gold.find("base_color")->text.substr(0, 4), "[1, ");
  EXPECT_EQ(gold.find("coat_weight"), nullptr);
  const Value& lacquer = foreign.materials[3].value;
  EXPECT_NEAR(lacquer.find("coat_weight")->number, 0.75, 1e-5);
  EXPECT_NEAR(lacquer.find("coat_roughness")->number, 0.25, 1e-5);
  EXPECT_NEAR(lacquer.find("specular_ior")->number, 1.45, 1e-4) << "that of the surface, not of it under its coat";
}

TEST(Gltf, ACameraWithoutPerspectiveStaysOne) {
  const Folder folder("gltf");
  std::string text = two_boxes;
  const std::string perspective = R"("fov": 35)";
  text.replace(text.find(perspective), perspective.size(), R"("type": "orthographic", "height": 3)");
  const LoadedScene scene = load(folder.write("scene.jsonc", text), true);
  export_scene(scene, *make_mesh_writer(folder.file("mesh.glb"), false, scene.scene->names.materials),
               [](double, std::uint64_t) {});
  AssetFolder assets(folder.file("again.jsonc"));
  Diagnostics diagnostics;
  const ForeignScene foreign = read_gltf(folder.file("mesh.glb"), assets, diagnostics);
  ASSERT_EQ(foreign.cameras.size(), 1u);
  const Value& camera = foreign.cameras[0].value;
  EXPECT_EQ(camera.find("type")->text, "orthographic");
  EXPECT_NEAR(camera.find("height")->number, 3, 1e-4);
  const double from[] = {1, 2, 8};
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(camera.find("from")->items[i].number, from[i], 1e-4);
}

constexpr const char* triangle = R"({
  "asset": { "version": "2.0" }, "scene": 0, "scenes": [ { "nodes": [ 0 ] } ],
  "nodes": [ { "children": [ 1, 2 ], "translation": [ 0, 1, 0 ] },
             { "mesh": 0, "rotation": [ 0, 0.7071067811865476, 0, 0.7071067811865476 ], "scale": [ 2, 2, 2 ] },
             { "extensions": { "KHR_lights_punctual": { "light": 0 } } } ],
  "extensions": { "KHR_lights_punctual": { "lights": [ { "type": "directional", "intensity": 2 } ] } },
  "meshes": [ { "primitives": [ { "attributes": { "POSITION": 0 }, "indices": 1 } ] } ],
  "accessors": [ { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" },
                 { "bufferView": 1, "componentType": 5121, "count": 3, "type": "SCALAR" } ],
  "bufferViews": [ { "buffer": 0, "byteLength": 36 }, { "buffer": 0, "byteOffset": 36, "byteLength": 3 } ],
  "buffers": [ { "uri": "triangle.bin", "byteLength": 39 } ] })";

std::string triangle_bytes() {
  const float positions[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  return std::string(reinterpret_cast<const char*>(positions), sizeof positions) + std::string("\0\1\2", 3);
}

TEST(Gltf, NodesAndFilesBesideIt) {
  const Folder folder("gltf");
  folder.write("triangle.bin", triangle_bytes());
  const ForeignScene scene = read(folder.write("triangle.gltf", triangle));
  ASSERT_EQ(scene.objects.size(), 1u);
  const Vec3d corner = scene.objects[0].to_parent.point({1, 0, 0});  // turned by 90 degrees about y
  EXPECT_NEAR(length(corner - Vec3d{0, 1, -2}), 0, 1e-9);
  EXPECT_EQ(scene.models[0].mesh->face_count(), 1u);
  ASSERT_EQ(scene.lights.size(), 1u);
  EXPECT_EQ(scene.lights[0].find("irradiance")->items[0].number, 2);
}

// The triangle with these bytes as colours of its vertices: four each, of which the last is opacity.
ForeignScene colored_triangle(const Folder& folder, const std::string& colors, std::string* warning = nullptr) {
  std::string text = triangle;
  const auto replace = [&](const std::string& from, const std::string& to) {
    text.replace(text.find(from), from.size(), to);
  };
  replace(R"("POSITION": 0 })", R"("POSITION": 0, "COLOR_0": 2 })");
  replace(R"("type": "SCALAR" } ])",
          R"("type": "SCALAR" },
      { "bufferView": 2, "componentType": 5121, "normalized": true, "count": 3, "type": "VEC4" } ])");
  replace(R"("byteLength": 3 } ])", R"("byteLength": 3 }, { "buffer": 0, "byteOffset": 39, "byteLength": 12 } ])");
  replace(R"("byteLength": 39)", R"("byteLength": 51)");
  folder.write("triangle.bin", triangle_bytes() + colors);
  std::vector<std::string> messages;
  ForeignScene scene = read(folder.write("colored.gltf", text), warning ? &messages : nullptr);
  if (warning && !messages.empty()) *warning = messages[0];
  return scene;
}

// Three colours lie on a plane, whatever they are.
TEST(Gltf, ColorsOfVerticesAreReadFromUv) {
  const Folder folder("gltf");
  const ForeignScene scene = colored_triangle(folder, "\xff\x33\x33\xff\x33\xff\x33\xff\x33\x33\xff\xff");
  const ForeignModel& model = scene.models.at(0);
  const auto material = std::ranges::find(scene.materials, model.material, &Member::key);
  ASSERT_NE(material, scene.materials.end());
  Symbols symbols;
  symbols.add("u", ValueType::Scalar, "");
  symbols.add("v", ValueType::Scalar, "");
  const auto color = Expression::compile(material->value.find("base_color")->text, symbols, ValueType::Vector);
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const Vec2d uv = model.mesh->uv[model.mesh->corner_uv[corner]];
    const Vec3f values[] = {Vec3f(float(uv.x)), Vec3f(float(uv.y))};
    const Vec3f found = color->evaluate_vector(values);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(found[k], std::size_t(k) == corner ? 1 : 0.2, 1e-5) << corner;
  }
}

TEST(VertexColors, PlanesAreFoundAndDistancesFromThem) {
  std::vector<Vec3f> greys, cube;
  for (int i = 0; i <= 4; ++i) greys.push_back(Vec3f(0.2f * float(i)));
  const ColorPlane line = nearest_plane(greys);
  EXPECT_EQ(line.along_v, Vec3d{});
  EXPECT_EQ(line.aside, Vec3d{});
  EXPECT_NEAR(std::abs(line.uv[1].x - line.uv[0].x), 0.25, 1e-6);
  for (int i = 0; i < 8; ++i) cube.push_back({float(i & 1), float(i >> 1 & 1), float(i >> 2 & 1)});
  const ColorPlane plane = nearest_plane(cube);
  for (std::size_t i = 0; i < 8; ++i) {
    const Vec3d found =
        plane.corner + plane.along_u * plane.uv[i].x + plane.along_v * plane.uv[i].y + plane.aside * plane.distance[i];
    EXPECT_LT(length(found - Vec3d(cube[i])), 1e-6) << i;
  }
}

// Faces of other colours than a plane holds tell them by their names, as far as a face has one.
TEST(VertexColors, FacesAreNamedByTheirDistanceFromThePlane) {
  ColorPlane plane;
  plane.aside = {0, 0, 0.5};
  plane.distance = {0, 0, 0, 1, 1, 0};
  PolygonMesh mesh;
  mesh.face_starts = {0, 3, 6};
  mesh.corner_positions = mesh.corner_uv = {0, 1, 2, 3, 4, 5};
  mesh.face_names = {0, 0};
  const DistancesOfFaces distances = name_faces_by_distance(mesh, plane);
  EXPECT_EQ(mesh.names, (std::vector<std::string>{"color0", "color42"}));  // 63 * 2/3
  EXPECT_EQ(mesh.face_names, (std::vector<std::uint32_t>{0, 1}));
  EXPECT_NEAR(distances.by_name[1], 2. / 3, 1e-9);
  EXPECT_NEAR(distances.error, 0.5 / 3, 1e-9);
}

// A hard edge between two colours stays one where the surface is smooth: its corners keep them.
TEST(ForeignMesh, CornersKeepTheirUv) {
  ForeignMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.normals.assign(6, {0, 0, 1});
  mesh.uv = {{0, 0}, {0, 0}, {0, 0}, {1, 0}, {1, 0}, {1, 0}};
  mesh.add_face({0, 1, 2});
  mesh.add_face({3, 4, 5});
  MeshRepairs repairs;
  const PolygonMesh welded = to_polygon_mesh(mesh, repairs);
  EXPECT_EQ(welded.positions.size(), 4u);
  ASSERT_EQ(welded.corner_uv.size(), 6u);
  for (std::size_t c = 0; c < 6; ++c) EXPECT_EQ(welded.uv[welded.corner_uv[c]].x, c < 3 ? 0 : 1) << c;
}

TEST(Gltf, OneColorOfAllVerticesNeedsNoCoordinates) {
  const Folder folder("gltf");
  std::string warning;
  const ForeignScene scene =
      colored_triangle(folder, std::string("\xff\x33\0\x80\xff\x33\0\x80\xff\x33\0\x80", 12), &warning);
  const auto material = std::ranges::find(scene.materials, scene.models.at(0).material, &Member::key);
  ASSERT_NE(material, scene.materials.end());
  EXPECT_EQ(material->value.find("base_color")->text, "[1, 0.2, 0]");
  EXPECT_EQ(warning, "7:77 the opacity of vertices was left out");
  const ForeignScene white = colored_triangle(folder, std::string(12, '\xff'));
  EXPECT_TRUE(white.models.at(0).material.empty());
}

TEST(Gltf, ErrorsSayWhere) {
  const Folder folder("gltf");
  folder.write("triangle.bin", triangle_bytes());
  const auto first = [&](const std::string& from, const std::string& to) {
    std::string text = triangle;
    text.replace(text.find(from), from.size(), to);
    std::vector<std::string> messages;
    read(folder.write("broken.gltf", text), &messages);
    return messages.empty() ? std::string() : messages[0].substr(messages[0].find(' ') + 1);
  };
  EXPECT_EQ(first("\"2.0\"", "\"1.0\""), "the file is no glTF 2.0");
  EXPECT_EQ(first(triangle, "\n"), "the file is empty; expected glTF 2.0");
  EXPECT_EQ(first("\"count\": 3", "\"count\": 4"), "4 items do not fit into 36 bytes");
  EXPECT_EQ(first("\"count\": 3", "\"count\": 9007199254740992"), "9007199254740992 items do not fit into 36 bytes");
  EXPECT_EQ(first("\"mesh\": 0", "\"mesh\": 1"), "there is no such item of \"meshes\"; there are 1, from 0 on");
  EXPECT_EQ(first("\"byteLength\": 36", "\"byteLength\": 99"), "bytes 0 to 99 leave the buffer of 39");
  EXPECT_EQ(first("\"triangle.bin\"", "\"../triangle.bin\""), "\"../triangle.bin\" leaves the folder of the file");
  EXPECT_EQ(first("\"children\": [ 1, 2 ]", "\"children\": [ 0, 0 ]"),
            "nodes nest deeper than 64, or are more than 1000000");
  EXPECT_EQ(first("\"VEC3\"", "\"VEC2\""), "expected an accessor of 3 numbers an item, found 2");
}

// Two triangles of a smooth square whose diagonal is a seam: it shades smoothly, and has both u of its vertices.
TEST(Gltf, SeamsOfTexturesStay) {
  const Folder folder("gltf");
  const float positions[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0};
  const float normals[] = {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1};
  const float uv[] = {0, 0, 0.5f, 0, 0, 1, 1, 0, 1, 1, 0.5f, 1};
  const auto bytes_of = [](const auto& values) {
    return std::string(reinterpret_cast<const char*>(&values[0]), sizeof values);
  };
  folder.write("square.bin", bytes_of(positions) + bytes_of(normals) + bytes_of(uv));
  folder.write("bark.png", "");
  const std::string text =
      R"({ "asset": { "version": "2.0" }, "scenes": [ { "nodes": [ 0 ] } ], "nodes": [ { "mesh": 0 } ],
  "meshes": [ { "primitives": [ { "attributes": { "POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2 }, "material": 0 } ] } ],
  "materials": [ { "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } } ],
  "images": [ { "uri": "bark.png" } ], "textures": [ { "source": 0 } ],
  "accessors": [ { "bufferView": 0, "componentType": 5126, "count": 6, "type": "VEC3" },
                 { "bufferView": 1, "componentType": 5126, "count": 6, "type": "VEC3" },
                 { "bufferView": 2, "componentType": 5126, "count": 6, "type": "VEC2" } ],
  "bufferViews": [ { "buffer": 0, "byteLength": 72 }, { "buffer": 0, "byteOffset": 72, "byteLength": 72 },
                   { "buffer": 0, "byteOffset": 144, "byteLength": 48 } ],
  "buffers": [ { "uri": "square.bin", "byteLength": 192 } ] })";
  const ForeignScene scene = read(folder.write("square.gltf", text));
  const PolygonMesh& mesh = *scene.models.at(0).mesh;
  EXPECT_EQ(mesh.positions.size(), 4u);
  const double u[] = {0, 0.5, 0, 1, 1, 0.5};
  ASSERT_EQ(mesh.corner_uv.size(), 6u);
  for (std::size_t c = 0; c < 6; ++c) EXPECT_EQ(mesh.uv[mesh.corner_uv[c]].x, u[c]) << c;
}

TEST(Gltf, AnImageThatIsMissingIsAnErrorAtItsPlace) {
  const Folder folder("gltf");
  folder.write("triangle.bin", triangle_bytes());
  std::string text = triangle;
  text.insert(text.rfind('}'), R"(, "images": [ { "uri": "bark.png" } ], "textures": [ { "source": 0 } ],
  "materials": [ { "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } } ] )");
  std::vector<std::string> messages;
  read(folder.write("triangle.gltf", text), &messages);
  ASSERT_FALSE(messages.empty());
  EXPECT_NE(messages[0].find("cannot read"), std::string::npos) << messages[0];
  EXPECT_NE(messages[0].find("bark.png"), std::string::npos) << messages[0];
  EXPECT_EQ(messages[0].substr(0, 6), "11:85 ") << messages[0];
}

TEST(Gltf, IndicesAndNumbersAreChecked) {
  const Folder folder("gltf");
  const auto path = folder.write("triangle.gltf", triangle);
  std::string bytes = triangle_bytes();
  bytes[38] = 3;
  folder.write("triangle.bin", bytes);
  std::vector<std::string> messages;
  read(path, &messages);
  EXPECT_EQ(messages.at(0), "7:79 index 2 is 3; there are 3 vertices");
  bytes = triangle_bytes();
  std::memcpy(bytes.data() + 8, "\0\0\xc0\x7f", 4);
  folder.write("triangle.bin", bytes);
  messages.clear();
  read(path, &messages);
  EXPECT_EQ(messages.at(0), "7:63 item 0 of the accessor is not finite");
}

TEST(Gltf, BrokenFilesEnd) {
  const Folder folder("gltf");
  std::ostringstream stream;
  stream << std::ifstream(exported(folder), std::ios::binary).rdbuf();
  const std::string good = stream.str();
  const auto check = [&](const std::string& bytes) {
    std::vector<std::string> messages;
    const ForeignScene scene = read(folder.write("broken.glb", bytes), &messages);
    for (const ForeignModel& m : scene.models)
      for (const std::uint32_t v : m.mesh->corner_positions) ASSERT_LT(v, m.mesh->positions.size());
  };
  for (std::size_t size = 0; size < good.size(); size += good.size() / 60) check(good.substr(0, size));
  for (Key k = 0; k < 150; ++k) {
    std::string spoilt = good;
    for (Key i = 0; i < 3; ++i) spoilt[hash_keys(k, i, 1) % 3000] = char(hash_keys(k, i, 2));
    check(spoilt);
  }
}

}  // namespace
}  // namespace meristem
