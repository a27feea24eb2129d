#include "core/base/problems.h"

#include <gtest/gtest.h>

#include "core/base/check.h"

namespace fascicle {
namespace {

TEST(ProblemsTest, JoinsPaths) {
  EXPECT_EQ(JoinPath("bodies[0]", "mesh"), "bodies[0].mesh");
  EXPECT_EQ(JoinPath("", "mesh"), "mesh");
  EXPECT_EQ(JoinPath("bodies[0]", ""), "bodies[0]");
  EXPECT_EQ(JoinPath("values", "[2]"), "values[2]");
  EXPECT_EQ(IndexPath("bodies", 2), "bodies[2]");
}

TEST(ProblemsTest, PrefixesAndPrints) {
  Problems inner, outer;
  inner.Add("mesh", "the file is empty", "is it complete?");
  inner.Add("", "something else");
  outer.Append("bodies[1]", inner);
  ASSERT_EQ(outer.count(), 2u);
  EXPECT_EQ(outer.ToString(), "bodies[1].mesh: the file is empty (is it complete?)\nbodies[1]: something else\n");
}

TEST(ProblemsTest, KeepsTheFirstAndCountsAll) {
  Problems inner, outer;
  EXPECT_TRUE(outer.empty());
  for (int i = 0; i < 1000; ++i) inner.Add(IndexPath("nodes", i), "bad");
  outer.Add("first", "bad");
  outer.Append("mesh", inner);
  EXPECT_EQ(inner.kept().size(), Problems::kMaxKept);
  EXPECT_EQ(outer.kept().size(), Problems::kMaxKept);
  EXPECT_EQ(outer.count(), 1001u);
  EXPECT_EQ(outer.kept().back().path, "mesh.nodes[198]");
  EXPECT_TRUE(outer.ToString().ends_with("and 801 more\n"));
}

TEST(CheckDeathTest, PrintsAndAborts) {
  FASCICLE_CHECK(1 + 1 == 2, "sums");
  EXPECT_DEATH(FASCICLE_CHECK(1 + 1 == 3, "sums are wrong"), "problems_test.cc.*1 \\+ 1 == 3: sums are wrong");
}

}  // namespace
}  // namespace fascicle
