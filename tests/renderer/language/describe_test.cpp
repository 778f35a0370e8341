#include "renderer/language/describe.h"

#include "sample_catalogue.h"

#include <gtest/gtest.h>

#include <sstream>

namespace meristem {
namespace {

using namespace testing;

struct Wordy : Anything {
  explicit Wordy(Params& p) {
    std::string doc;
    for (int i = 0; i < 60; ++i) doc += "word ";
    p.real("length", 1, {0, 5, "m"}, doc.c_str());
    p.real("either", 0, any_range, "a | b");
  }
};

std::size_t longest_line(const std::string& text) {
  std::istringstream lines(text);
  std::size_t longest = 0;
  for (std::string line; std::getline(lines, line);) longest = std::max(longest, line.size());
  return longest;
}

TEST(Describe, ShowsAPage) {
  EXPECT_EQ(describe(sample_catalogue(), "sky"),
            "light sky\n"
            "  Sun and clear sky\n"
            "\n"
            "  elevation  number, 0 to 90 deg; default 40\n"
            "             height of the sun above the horizon\n"
            "\n"
            "  bands      whole number, 1 to 11; default 3\n"
            "             of the spectrum\n"
            "\n"
            "  sun        true or false; default true\n"
            "             whether the disc of the sun shines as well\n"
            "\n"
            "  ground     colour; default 0.3\n"
            "             albedo of the ground\n"
            "\n"
            "  model      one of hosek, preetham; default \"hosek\"\n"
            "             which fit to measured skies\n");
}

TEST(Describe, SaysWhatMayDependOnTime) {
  EXPECT_NE(describe(sample_catalogue(), "pinhole").find("number, 1 to 170 deg, or an expression of time; default 40"),
            std::string::npos);
}

TEST(Describe, NamesTheFormOfRawParameters) {
  const std::string grow = describe(sample_catalogue(), "grow");
  EXPECT_NE(grow.find("rules  object; required\n"), std::string::npos) << grow;
  const std::string subdivide = describe(sample_catalogue(), "subdivide");
  EXPECT_NE(subdivide.find("place      vector expression\n"), std::string::npos) << subdivide;
}

TEST(Describe, FindsKindsAndFullNames) {
  const Catalogue catalogue = sample_catalogue();
  EXPECT_EQ(describe(catalogue, "light"), describe(catalogue, "sky") + "\n" + describe(catalogue, "rectangle"));
  EXPECT_EQ(describe(catalogue, "light.sky"), describe(catalogue, "sky"));
  EXPECT_EQ(describe(catalogue, "moon"), "");
}

TEST(Describe, ListsEverythingWithoutAName) {
  const Catalogue catalogue = sample_catalogue();
  const std::string overview = describe(catalogue, "");
  for (const ComponentInfo& c : catalogue.components)
    EXPECT_NE(overview.find("\n    " + c.name + " "), std::string::npos) << c.name;
  EXPECT_NE(overview.find("Lights (light)\n"), std::string::npos);
  EXPECT_LE(longest_line(overview), 100u);
}

TEST(Describe, KeepsToAHundredColumns) {
  Registry<Anything> registry("light");
  registry.add<Wordy>("wordy", "word");
  Catalogue catalogue;
  catalogue.components = registry.infos();
  const std::string page = describe(catalogue, "wordy");
  EXPECT_LE(longest_line(page), 100u);
  EXPECT_GT(longest_line(page), 90u);
}

TEST(Describe, KnowsItsNames) {
  const std::vector<std::string> names = described_names(sample_catalogue());
  EXPECT_TRUE(std::is_sorted(names.begin(), names.end()));
  for (const std::string& name : names) EXPECT_NE(describe(sample_catalogue(), name), "") << name;
}

TEST(Markdown, HasAChapterForEachKindAndARowForEachParameter) {
  const std::string text = markdown(sample_catalogue());
  EXPECT_NE(text.find("\n## Lights\n"), std::string::npos);
  EXPECT_NE(text.find("\n### sky\n\nSun and clear sky\n"), std::string::npos);
  EXPECT_NE(text.find("\n| `elevation` | number, 0 to 90 deg | `40` | height of the sun above the horizon |\n"),
            std::string::npos);
  EXPECT_NE(text.find("\n| `corner` | [x, y, z] | required | where it begins |\n"), std::string::npos);
  EXPECT_NE(text.find("\n### orthographic\n\nParallel rays\n\nNo parameters.\n"), std::string::npos);
}

TEST(Markdown, EscapesWhatWouldEndACell) {
  Registry<Anything> registry("light");
  registry.add<Wordy>("wordy", "word");
  Catalogue catalogue;
  catalogue.components = registry.infos();
  EXPECT_NE(markdown(catalogue).find("| a \\| b |"), std::string::npos);
}

}  // namespace
}  // namespace meristem
