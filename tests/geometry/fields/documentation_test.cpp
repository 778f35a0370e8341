// docs/expressions.md tells of every function, with its signature and its line.
#include "geometry/fields/functions.h"
#include "tests/geometry/fields/expression_support.h"

#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <sstream>

namespace meristem {
namespace {

TEST(Documentation, ListsEveryFunction) {
  std::ifstream file(MERISTEM_SOURCE_DIR "/docs/expressions.md");
  ASSERT_TRUE(file);
  std::stringstream text;
  text << file.rdbuf();
  for (const FunctionInfo& f : expression_functions())
    EXPECT_NE(text.str().find("| `" + std::string(f.signature) + "` | " + std::string(f.doc) + " |"), std::string::npos)
        << f.name;
}

TEST(Documentation, NamesAreUniqueAndTested) {
  std::set<std::string_view> names;
  std::string all;
  for (const std::string& text : test::all_operations()) all += text + "\n";
  for (const FunctionInfo& f : expression_functions()) {
    EXPECT_TRUE(names.insert(f.name).second) << f.name;
    const bool is_tested = f.group == "grids" ||  // with grids to name: tests/geometry/volumes
                           all.find(std::string(f.name) + "(") != std::string::npos;
    EXPECT_TRUE(is_tested) << f.name << " is not among all_operations()";
    EXPECT_TRUE(f.signature.starts_with(std::string(f.name) + "(")) << f.name;
  }
}

}  // namespace
}  // namespace meristem
