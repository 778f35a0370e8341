#include "geometry/base/registry.h"
#include "values.h"

#include <gtest/gtest.h>

namespace meristem {
namespace {

using namespace testing;

struct Plant {
  virtual ~Plant() = default;
  virtual double height() const = 0;
};

struct Fern : Plant {
  explicit Fern(Params& params) : height_(params.real("height", 0.6, not_negative, "of the longest frond")) {}
  double height() const override { return height_; }
  double height_;
};

struct Oak : Plant {
  explicit Oak(Params&) {}
  double height() const override { return 20; }
};

class RegistryTest : public ::testing::Test {
 protected:
  RegistryTest() {
    plants_.add<Fern>("fern", "a fern");
    plants_.add<Oak>("oak", "an oak");
  }

  std::unique_ptr<Plant> create(const Value& value, const std::string& fallback = "") {
    return plants_.create(value, fallback, diagnostics_);
  }
  std::string message() const { return diagnostics_.list().empty() ? "" : diagnostics_.list()[0].message; }

  Registry<Plant> plants_{"plant"};
  Diagnostics diagnostics_;
};

TEST_F(RegistryTest, MakesWhatTypeNames) {
  const auto fern = create(object({{"type", text("fern")}, {"height", number(2)}}));
  ASSERT_NE(fern, nullptr);
  EXPECT_EQ(fern->height(), 2);
  EXPECT_EQ(create(object({{"type", text("oak")}}))->height(), 20);
  EXPECT_EQ(message(), "");
}

TEST_F(RegistryTest, MakesTheFallbackWithoutType) {
  EXPECT_EQ(create(object({}), "oak")->height(), 20);
  EXPECT_EQ(create(object({}), ""), nullptr);
  EXPECT_EQ(message(), "a plant needs a \"type\"; known: fern, oak");
}

TEST_F(RegistryTest, SuggestsTheNearestType) {
  EXPECT_EQ(create(object({{"type", text("fren")}})), nullptr);
  EXPECT_EQ(message(), "no plant named \"fren\"; did you mean \"fern\"?; known: fern, oak");
}

TEST_F(RegistryTest, ReportsAnUnknownFallback) {
  EXPECT_EQ(create(object({}), "pine"), nullptr);
  EXPECT_EQ(message(), "no plant named \"pine\"; known: fern, oak");
}

TEST_F(RegistryTest, ReportsWrongShapes) {
  EXPECT_EQ(create(number(1)), nullptr);
  EXPECT_EQ(create(object({{"type", number(1)}})), nullptr);
  EXPECT_EQ(diagnostics_.list()[0].message, "expected a plant as an object, found a number");
  EXPECT_EQ(diagnostics_.list()[1].message, "\"type\" names a plant: expected text, found a number");
}

TEST_F(RegistryTest, ReportsUnknownKeys) {
  create(object({{"type", text("fern")}, {"heigth", number(2)}}));
  EXPECT_EQ(message(), "plant \"fern\" has no \"heigth\"; did you mean \"height\"?");
}

TEST_F(RegistryTest, DescribesItsComponents) {
  EXPECT_EQ(plants_.names(), (std::vector<std::string>{"fern", "oak"}));
  const std::vector<ComponentInfo> infos = plants_.infos();
  ASSERT_EQ(infos.size(), 2u);
  EXPECT_EQ(infos[0].kind, "plant");
  EXPECT_EQ(infos[0].doc, "a fern");
  ASSERT_EQ(infos[0].describe().size(), 1u);
  EXPECT_EQ(infos[0].describe()[0].default_text, "0.6");
  EXPECT_TRUE(infos[1].describe().empty());
}

}  // namespace
}  // namespace meristem
