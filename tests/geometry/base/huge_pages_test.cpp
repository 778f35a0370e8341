#include "geometry/base/huge_pages.h"

#include <gtest/gtest.h>

namespace meristem {
namespace {

TEST(HugePages, AreAskedForWhereTheyAreGivenOnRequest) {
  const auto tunables = tunables_for_huge_pages("always [madvise] never", nullptr);
  ASSERT_TRUE(tunables);
  EXPECT_TRUE(tunables->starts_with("glibc.malloc.hugetlb=1:"));
  EXPECT_EQ(tunables_for_huge_pages("always [madvise] never", ""), tunables);
  EXPECT_EQ(tunables_for_huge_pages("always [madvise] never", "glibc.rtld.nns=2"), "glibc.rtld.nns=2:" + *tunables);
}

TEST(HugePages, AreLeftAloneElsewhere) {
  EXPECT_FALSE(tunables_for_huge_pages("[always] madvise never", nullptr));
  EXPECT_FALSE(tunables_for_huge_pages("always madvise [never]", nullptr));
  EXPECT_FALSE(tunables_for_huge_pages("", nullptr)) << "a system without";
  EXPECT_FALSE(tunables_for_huge_pages("always [madvise] never", "glibc.malloc.hugetlb=0")) << "somebody decided";
  EXPECT_FALSE(tunables_for_huge_pages("always [madvise] never",
                                       tunables_for_huge_pages("always [madvise] never", nullptr)->c_str()))
      << "no second start";
}

}  // namespace
}  // namespace meristem
