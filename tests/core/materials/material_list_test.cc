#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/materials/material.h"

namespace fascicle {
namespace {

TEST(Laws, AreThoseOfTheSceneInItsOrder) {
  std::vector<std::string_view> names;
  for (const LawInfo& law : Laws()) names.push_back(law.name);
  EXPECT_THAT(names, ::testing::ElementsAre("linear_elastic", "st_venant_kirchhoff", "corotated_linear", "neo_hookean",
                                            "mooney_rivlin", "muscle", "tendon", "trans_iso_mooney_rivlin", "yeoh",
                                            "ogden", "fung_fibre", "holzapfel_gasser_ogden", "tabulated_muscle",
                                            "blemker_muscle", "blemker_tendon"));
}

TEST(Laws, AreFoundByName) {
  for (const LawInfo& law : Laws()) EXPECT_EQ(FindLaw(law.name), &law);
  EXPECT_EQ(FindLaw("hooke"), nullptr);
  EXPECT_EQ(FindLaw(""), nullptr);
  EXPECT_EQ(FindLaw("muscle "), nullptr);
}

TEST(Laws, DescribeThemselves) {
  const std::set<std::string_view> kFibrous = {
      "muscle",           "tendon",         "trans_iso_mooney_rivlin", "fung_fibre", "holzapfel_gasser_ogden",
      "tabulated_muscle", "blemker_muscle", "blemker_tendon"};
  const std::set<std::string_view> kUnits = {"Pa", "1", "1/s", "rad"};
  for (const LawInfo& law : Laws()) {
    EXPECT_FALSE(std::string_view(law.title).empty());
    EXPECT_FALSE(std::string_view(law.source).empty());
    EXPECT_EQ(law.needs_fibres, kFibrous.count(law.name) == 1) << law.name;
    std::set<std::string_view> names;
    for (const ParameterInfo& p : law.parameters) {
      EXPECT_TRUE(names.insert(p.name).second) << p.name;
      EXPECT_LT(p.min, p.max);
      EXPECT_EQ(kUnits.count(p.unit), 1u) << p.unit;
      EXPECT_FALSE(std::string_view(p.meaning).empty());
      if (std::isnan(p.default_value)) continue;
      EXPECT_TRUE(p.min_open ? p.default_value > p.min : p.default_value >= p.min) << p.name;
      EXPECT_TRUE(p.max_open ? p.default_value < p.max : p.default_value <= p.max) << p.name;
    }
  }
}

TEST(Laws, MakeTheLawTheyName) {
  for (const LawInfo& law : Laws()) {
    const std::vector<double> values(law.parameters.size(), 0.25);
    const Material material = law.make(values);
    EXPECT_STREQ(std::visit([](const auto& m) { return m.kName; }, material), law.name);
  }
}

}  // namespace
}  // namespace fascicle
