// The objects of a scene: which model each stands for.
#include "geometry/base/source.h"
#include "geometry/cells/shown_surfaces.h"
#include "renderer/language/jsonc_reader.h"
#include "renderer/loading/load_part.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

namespace meristem {
namespace {

constexpr const char* stem = R"json({ "stem": { "base": { "type": "prism", "cap": "s" }, "steps": [
  { "subdivide": 1 }, { "grow": 2, "rules": { "s": { "template": "segment", "faces": { "cap": "s" } } } },
  { "subdivide": 3 } ] } })json";

// What is built of objects written so, and the messages.
struct Objects {
  static inline const std::vector<std::string> materials{"", "bark", "leaf", "gold", "red"};
  Diagnostics diagnostics;
  std::vector<Placement> list;

  explicit Objects(const std::string& text, const char* models = stem) {
    const auto read = [&](const std::string& t) {
      return read_jsonc(std::make_shared<SourceText>(SourceText{"objects", t}), diagnostics);
    };
    const Value model_values = read(models), object_values = read(text);
    const auto material_index = [this](const std::string& name, const Location& where) {
      const auto known = std::ranges::find(materials, name);
      if (known == materials.end()) diagnostics.error(where, fmt::format("no material \"{}\"", name));
      return int(known - materials.begin());
    };
    const ModelContext context{material_index, "", diagnostics, {}};
    list = PartLibrary(&model_values, context).place(object_values);
  }
  std::string first_message() const { return diagnostics.list().empty() ? "" : diagnostics.list()[0].message; }
};

TEST(Objects, CountsReplaceThoseOfTheFirstSteps) {
  const Objects objects(R"json([ { "model": "stem" }, { "model": "stem", "counts": [0, 5] },
    { "model": "stem", "counts": [2, 0, 1] } ])json");
  ASSERT_EQ(objects.first_message(), "");
  ASSERT_EQ(objects.list.size(), 3u);
  EXPECT_EQ(objects.list[0].part->model->levels(), 1 + 2 + 3);
  EXPECT_EQ(objects.list[1].part->model->levels(), 0 + 5 + 3);
  EXPECT_EQ(objects.list[2].part->model->levels(), 2 + 0 + 1);
}

TEST(Objects, ShareAModelWhenTheyCountAlike) {
  const Objects objects(R"json([ { "model": "stem", "counts": [1] }, { "model": "stem", "counts": [1] },
    { "model": "stem", "counts": [2] }, { "model": "stem", "counts": [1], "seed": 3 } ])json");
  ASSERT_EQ(objects.list.size(), 4u);
  EXPECT_EQ(objects.list[0].part, objects.list[1].part);
  EXPECT_NE(objects.list[0].part, objects.list[2].part);
  EXPECT_NE(objects.list[0].part, objects.list[3].part);
}

// It is read for each seed; what is wrong is said once, and nothing comes of it, however often it is found.
TEST(Objects, AModelThatIsWrongIsReportedOnce) {
  std::string text;
  for (int seed = 0; seed < 300; ++seed)
    text += fmt::format("{}{{ \"model\": \"m\", \"seed\": {} }}", seed ? ", " : "[ ", seed);
  const Objects objects(
      text + " ]", R"json({ "m": { "base": { "type": "box" }, "steps": [ { "subdivide": 1, "place": "Q" } ] } })json");
  ASSERT_EQ(objects.diagnostics.list().size(), 1u);
  EXPECT_NE(objects.first_message().find("unknown variable"), std::string::npos);
  EXPECT_EQ(objects.diagnostics.errors_found(), 300u);
  EXPECT_TRUE(objects.list.empty());
}

TEST(Objects, WrongCountsAreRefused) {
  EXPECT_EQ(Objects(R"json([ { "model": "stem", "counts": [1, 1, 1, 1] } ])json").first_message(),
            "the model has 3 steps; \"counts\" has 4 numbers");
  for (const char* counts : {"2", "[1.5]", "[-1]", "[\"1\"]"})
    EXPECT_EQ(Objects(fmt::format(R"json([ {{ "model": "stem", "counts": {} }} ])json", counts)).first_message(),
              "\"counts\" is an array of whole numbers, one for each of the model's first steps");
  EXPECT_NE(Objects(R"json([ { "model": "stem", "counts": [16] } ])json").first_message().find("0 to 15"),
            std::string::npos);
}

constexpr const char* plants = R"json({
  "plant": { "base": { "type": "prism", "cap": "s" }, "material": "bark",
             "steps": [ { "grow": 1, "rules": { "s": { "template": "spike", "material": "leaf" } } } ] },
  "plain": { "base": { "type": "box" } },
  "pair": { "group": [ { "model": "plant" }, { "model": "plant", "materials": { "leaf": "bark" } } ] } })json";

// The materials of an object's faces when it has grown.
std::set<std::string> materials_of(const Part& part) {
  std::set<std::string> found;
  for_each_tessellation({part.model, nullptr, 0, {}}, [&](const Tessellation& cell, double) {
    for (std::size_t i = 0; i < cell.origins.size(); ++i)
      found.insert(Objects::materials[std::size_t(cell.origins[i].material)]);
  });
  return found;
}

using Names = std::set<std::string>;

TEST(Objects, HaveMaterialsOfTheirOwn) {
  const Objects objects(R"json([ { "model": "plant" }, { "model": "plant", "materials": { "leaf": "gold" } },
    { "model": "plant", "material": "red" }, { "model": "plant", "material": "red", "materials": { "bark": "gold" } },
    { "model": "plain" }, { "model": "plain", "material": "gold" } ])json",
                        plants);
  ASSERT_EQ(objects.first_message(), "");
  const std::vector<Names> expected{{"bark", "leaf"}, {"bark", "gold"}, {"red"}, {"gold", "red"}, {""}, {"gold"}};
  ASSERT_EQ(objects.list.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(materials_of(*objects.list[i].part), expected[i]) << i;
}

TEST(Objects, HandTheirMaterialsOnToWhatTheyArePartOf) {
  const Objects objects(R"json([ { "model": "pair", "materials": { "bark": "gold" } }, { "model": "pair" } ])json",
                        plants);
  ASSERT_EQ(objects.first_message(), "");
  const auto part_of = [&](std::size_t object, std::size_t member) {
    return materials_of(*objects.list[object].part->members[member].part);
  };
  EXPECT_EQ(part_of(0, 0), (Names{"gold", "leaf"}));
  EXPECT_EQ(part_of(0, 1), (Names{"gold"})) << "its own names first";
  EXPECT_EQ(part_of(1, 0), (Names{"bark", "leaf"}));
  EXPECT_EQ(part_of(1, 1), (Names{"bark"}));
}

TEST(Objects, ShareAModelWhenTheirMaterialsAreTheSame) {
  const Objects objects(R"json([ { "model": "plant", "material": "red" }, { "model": "plant", "material": "red" },
    { "model": "plant" } ])json",
                        plants);
  EXPECT_EQ(objects.list[0].part, objects.list[1].part);
  EXPECT_NE(objects.list[0].part, objects.list[2].part);
}

TEST(Objects, MaterialsThatAreNoneAreReported) {
  for (const char* object :
       {R"("material": "rde")", R"("materials": { "rde": "gold" })", R"("materials": { "leaf": "rde" })"})
    EXPECT_EQ(Objects(fmt::format(R"([ {{ "model": "plant", {} }} ])", object), plants).first_message(),
              "no material \"rde\"");
  EXPECT_EQ(Objects(R"([ { "model": "plant", "materials": { "leaf": 3 } } ])", plants).first_message(),
            "what takes the place of \"leaf\" is the name of a material");
  EXPECT_NE(Objects(R"([ { "model": "plant", "materials": "gold" } ])", plants).first_message(), "");
}

}  // namespace
}  // namespace meristem
