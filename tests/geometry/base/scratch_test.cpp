#include "geometry/base/scratch.h"

#include <gtest/gtest.h>

namespace meristem {
namespace {

TEST(Scratch, IsUsedAgainByItsThread) {
  const float* first;
  {
    Scratch<float> a(1000);
    first = a.data();
    Scratch<float> b(10);
    EXPECT_NE(b.data(), first);
  }
  Scratch<float> c(500);
  Scratch<float> d(500, 3.0f);
  EXPECT_TRUE(c.data() == first || d.data() == first);
  EXPECT_EQ(d.size(), 500u);
  for (const float x : d.span()) EXPECT_EQ(x, 3.0f);
}

}  // namespace
}  // namespace meristem
