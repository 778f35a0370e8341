#include "renderer/report/page.h"

#include "renderer/language/json_value.h"

#include <gtest/gtest.h>

namespace meristem {
namespace {

TEST(ReportPage, HoldsItsFiguresAndNoWayOut) {
  const std::string page = report_page(json::object({{"kind", json::text("</script><b>")}}));
  EXPECT_NE(page.find(R"({ "kind": "\u003c/script>\u003cb>" })"), std::string::npos);
  EXPECT_NE(page.find("uPlot"), std::string::npos);
  EXPECT_EQ(page.find("@DATA@"), std::string::npos);
  EXPECT_EQ(page.find("@STYLE@"), std::string::npos);
  EXPECT_EQ(page.find("@SCRIPT@"), std::string::npos);
}

TEST(ReportPage, ImagesArePngInsideTheText) {
  const Value v = report_image_value({"a title", "a note", {1, 1, 3, {1, 0, 0}}, "", ""});
  EXPECT_EQ(v.find("title")->text, "a title");
  EXPECT_EQ(v.find("low")->kind, Value::Kind::Null);
  // The first 9 bytes of every PNG, then of its header
  EXPECT_TRUE(v.find("src")->text.starts_with("data:image/png;base64,iVBORw0KGgoA")) << v.find("src")->text;
}

TEST(HeatMap, GoesFromBlackToPaleYellow) {
  const Image map = heat_map({4, 1, 1, {0, -1, 5, 100}}, 10);
  for (int c = 0; c < 3; ++c) EXPECT_EQ(map.pixels[std::size_t(c)], map.pixels[std::size_t(3 + c)]);
  EXPECT_EQ(map.pixels[2], 4.f / 255);
  EXPECT_EQ(map.pixels[6], 181.f / 255);
  EXPECT_EQ(map.pixels[9], 252.f / 255);
}

TEST(Quantile, IsTheValueBelowWhichAShareLies) {
  const Image values{5, 1, 1, {4, 1, 3, 0, 2}};
  EXPECT_EQ(quantile(values, 0), 0);
  EXPECT_EQ(quantile(values, 0.5), 2);
  EXPECT_EQ(quantile(values, 1), 4);
}

}  // namespace
}  // namespace meristem
