#include "proto/rules/parse_rule.h"

#include <cmath>

#include <gtest/gtest.h>

namespace fascicle {
namespace {

TEST(ParseRule, ReadsEveryPart) {
  const auto rule = ParseRule("Unit kg/m^3; range (0, 30000]; default 1060.");
  ASSERT_TRUE(rule.has_value());
  EXPECT_EQ(rule->unit, "kg/m^3");
  EXPECT_EQ(rule->values, 0);
  EXPECT_EQ(rule->min, 0);
  EXPECT_TRUE(rule->min_open);
  EXPECT_EQ(rule->max, 30000);
  EXPECT_FALSE(rule->max_open);
  EXPECT_EQ(rule->defaults, std::vector<double>({1060}));
  EXPECT_FALSE(rule->required);
  EXPECT_EQ(rule->range_text, "(0, 30000]");
  EXPECT_EQ(rule->default_text, "1060");
}

TEST(ParseRule, ReadsListsWithUnitsOfTwoWords) {
  const auto rule = ParseRule("Unit Pa s; 3 values; range (-inf, inf); default 0 -1.5 1e7.");
  ASSERT_TRUE(rule.has_value());
  EXPECT_EQ(rule->unit, "Pa s");
  EXPECT_EQ(rule->values, 3);
  EXPECT_TRUE(std::isinf(rule->min) && std::isinf(rule->max));
  EXPECT_EQ(rule->defaults, std::vector<double>({0, -1.5, 1e7}));
}

TEST(ParseRule, TellsRequiredFromOptional) {
  EXPECT_TRUE(ParseRule("Unit s; range (0, 1]; required.")->required);
  EXPECT_FALSE(ParseRule("Unit s; range (0, 1]; optional.")->required);
}

TEST(ParseRule, RefusesEverythingElse) {
  for (const char* line : {
           "",
           "Unit s.",
           "Unit s; range (0, 1]; required",
           "Unit s; range 0..1; required.",
           "Unit s; range (0, 1; required.",
           "Unit s; range (1, 0]; required.",
           "Unit s; range (0, one]; required.",
           "Unit s; range (0, 1]; maybe.",
           "Unit s; range (0, 1]; default.",
           "Unit s; range (0, 1]; default x.",
           "Unit ; range (0, 1]; required.",
           "Unit s; three values; range (0, 1]; required.",
           "Unit s; 3 values; range (0, 1]; default 1 1.",
           "Unit s; range (0, 1]; default 1 1.",
           "Unit s; 0 values; range (0, 1]; required.",
           "range (0, 1]; required.",
           "Unit s; Range (0, 1]; required.",
           "Unit s; range (0, 1]; required. More.",
           "Unit s; 3 values; range (0, 1]; required; now.",
       }) {
    EXPECT_FALSE(ParseRule(line).has_value()) << line;
  }
}

TEST(Split, KeepsTextAndRuleApart) {
  const SplitComment split = Split(" Mass per rest volume.\n Two lines.\n Unit kg/m^3; range (0, 1]; required.\n");
  EXPECT_EQ(split.text, "Mass per rest volume.\nTwo lines.");
  EXPECT_EQ(split.rule, "Unit kg/m^3; range (0, 1]; required.");
  EXPECT_EQ(Split(" No rule.\n").rule, "");
  EXPECT_EQ(Split("").text, "");
}

}  // namespace
}  // namespace fascicle
