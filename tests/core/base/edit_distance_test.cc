#include "core/base/edit_distance.h"

#include <gtest/gtest.h>

namespace fascicle {
namespace {

TEST(EditDistanceTest, CountsInsertionsDeletionsAndReplacements) {
  EXPECT_EQ(EditDistance("", ""), 0u);
  EXPECT_EQ(EditDistance("fibre", "fibre"), 0u);
  EXPECT_EQ(EditDistance("", "mesh"), 4u);
  EXPECT_EQ(EditDistance("mesh", ""), 4u);
  EXPECT_EQ(EditDistance("unti", "unit"), 2u);
  EXPECT_EQ(EditDistance("fibres", "fibre"), 1u);
  EXPECT_EQ(EditDistance("fibre", "fibres"), 1u);
  EXPECT_EQ(EditDistance("density", "densitx"), 1u);
  EXPECT_EQ(EditDistance("kitten", "sitting"), 3u);
}

}  // namespace
}  // namespace fascicle
