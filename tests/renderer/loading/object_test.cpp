// The objects of a scene: which model each stands for.
#include "geometry/base/source.h"
#include "renderer/language/jsonc_reader.h"
#include "renderer/loading/load_part.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace meristem {
namespace {

constexpr const char* models = R"json({ "stem": { "base": { "type": "prism", "cap": "s" }, "steps": [
  { "subdivide": 1 }, { "grow": 2, "rules": { "s": { "template": "segment", "faces": { "cap": "s" } } } },
  { "subdivide": 3 } ] } })json";

// What is built of objects written so, and the messages.
struct Objects {
  Diagnostics diagnostics;
  std::vector<Placement> list;

  explicit Objects(const std::string& text) {
    const auto read = [&](const std::string& t) {
      return read_jsonc(std::make_shared<SourceText>(SourceText{"objects", t}), diagnostics);
    };
    const Value model_values = read(models), object_values = read(text);
    const auto no_materials = [](const std::string&, const Location&) { return 0; };
    const ModelContext context{no_materials, "", diagnostics, {}};
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

TEST(Objects, WrongCountsAreRefused) {
  EXPECT_EQ(Objects(R"json([ { "model": "stem", "counts": [1, 1, 1, 1] } ])json").first_message(),
            "the model has 3 steps; \"counts\" has 4 numbers");
  for (const char* counts : {"2", "[1.5]", "[-1]", "[\"1\"]"})
    EXPECT_EQ(Objects(fmt::format(R"json([ {{ "model": "stem", "counts": {} }} ])json", counts)).first_message(),
              "\"counts\" is an array of whole numbers, one for each of the model's first steps");
  EXPECT_NE(Objects(R"json([ { "model": "stem", "counts": [16] } ])json").first_message().find("0 to 15"),
            std::string::npos);
}

}  // namespace
}  // namespace meristem
