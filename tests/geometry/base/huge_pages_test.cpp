#include "geometry/base/huge_pages.h"

#include <gtest/gtest.h>

namespace meristem {
namespace {

TEST(HugePages, AreAskedForWhereTheyAreGivenOnRequest) {
  EXPECT_EQ(tunables_for_huge_pages("always [madvise] never", nullptr), "glibc.malloc.hugetlb=1");
  EXPECT_EQ(tunables_for_huge_pages("always [madvise] never", ""), "glibc.malloc.hugetlb=1");
  EXPECT_EQ(tunables_for_huge_pages("always [madvise] never", "glibc.malloc.check=1"),
            "glibc.malloc.check=1:glibc.malloc.hugetlb=1");
}

TEST(HugePages, AreLeftAloneElsewhere) {
  EXPECT_FALSE(tunables_for_huge_pages("[always] madvise never", nullptr));
  EXPECT_FALSE(tunables_for_huge_pages("always madvise [never]", nullptr));
  EXPECT_FALSE(tunables_for_huge_pages("", nullptr)) << "a system without";
  EXPECT_FALSE(tunables_for_huge_pages("always [madvise] never", "glibc.malloc.hugetlb=0")) << "somebody decided";
  EXPECT_FALSE(tunables_for_huge_pages("always [madvise] never", "glibc.malloc.hugetlb=1")) << "no second start";
}

}  // namespace
}  // namespace meristem
