// Examples that take half a minute.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "example_fixture.h"

namespace fascicle::testing {
namespace {

TEST_F(ExampleTest, PlasticBlock) {
  const json summary = RunExample("plastic_block");
  EXPECT_NEAR(Final(summary, "probe/side/x"), -0.011, 0.002);
  EXPECT_GT(summary["series"]["block/volume_ratio"]["min"], 0.998);
  EXPECT_LT(summary["series"]["block/volume_ratio"]["max"], 1.002);
}

// With larger cells, because the original takes a minute.
TEST_F(ExampleTest, CrushedCube) {
  const std::string out = folder_ / "out";
  const json summary =
      RunExample("crushed_cube", {"--out", out, "--set", "eulerian.cell_size=0.0125", "--set", "eulerian.margin=1.2",
                                  "--set", "bodies[0].mesh.box.divisions=[12, 12, 12]", "--set",
                                  "bodies[0].regions[0].box={\"min\": [-1.3, -1.3, -1.3], \"max\": [1.3, 1.3, 1.3]}"});
  EXPECT_GT(summary["series"]["cube/volume_ratio"]["min"], 0.99);
  EXPECT_LT(summary["series"]["cube/volume_ratio"]["max"], 1.01);
  for (const char* axis : {"x", "y", "z"}) EXPECT_NEAR(Final(summary, std::string("probe/corner/") + axis), 0, 0.0125);
  // Crushed, then back in its original shape.
  const std::vector<double> energy = SeriesOf(folder_ / "out/series.csv", "energy/elastic");
  EXPECT_GT(*std::max_element(energy.begin(), energy.end()), 0.1);
  EXPECT_LT(energy.back(), 0.02 * *std::max_element(energy.begin(), energy.end()));
}

}  // namespace
}  // namespace fascicle::testing
