// Laws are declared twice: the message that a user writes and the list of the core. Both must agree.
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "core/materials/material.h"
#include "fascicle/v1/scene.pb.h"
#include "proto/rules/field_rules.h"

namespace fascicle {
namespace {

TEST(LawsAgree, EveryLawHasAMessageAndTheOtherWayRound) {
  const auto* oneof = v1::Material::descriptor()->FindOneofByName("law");
  ASSERT_NE(oneof, nullptr);
  ASSERT_EQ(static_cast<std::size_t>(oneof->field_count()), Laws().size());
  for (int i = 0; i < oneof->field_count(); ++i) EXPECT_EQ(oneof->field(i)->name(), Laws()[i].name);
}

TEST(LawsAgree, ParametersHaveTheSameNamesUnitsRangesAndDefaults) {
  const auto* oneof = v1::Material::descriptor()->FindOneofByName("law");
  for (int i = 0; i < oneof->field_count(); ++i) {
    const auto* message = oneof->field(i)->message_type();
    const LawInfo* law = FindLaw(oneof->field(i)->name());
    ASSERT_NE(law, nullptr) << oneof->field(i)->name();
    // What is not a number follows the numbers.
    const auto numbers = static_cast<int>(law->parameters.size());
    ASSERT_GE(message->field_count(), numbers) << law->name;
    for (int k = 0; k < message->field_count(); ++k) {
      const auto& field = *message->field(k);
      EXPECT_EQ(field.cpp_type() == google::protobuf::FieldDescriptor::CPPTYPE_DOUBLE, k < numbers)
          << field.full_name();
      if (k >= numbers) continue;
      const ParameterInfo& parameter = law->parameters[static_cast<std::size_t>(k)];
      SCOPED_TRACE(field.full_name());
      const auto rule = RuleOf(field);
      ASSERT_TRUE(rule.has_value());
      EXPECT_EQ(field.name(), parameter.name);
      EXPECT_EQ(rule->unit, parameter.unit);
      EXPECT_EQ(rule->min, parameter.min);
      EXPECT_EQ(rule->min_open, parameter.min_open);
      EXPECT_EQ(rule->max, parameter.max);
      EXPECT_EQ(rule->max_open, parameter.max_open);
      EXPECT_EQ(rule->required, std::isnan(parameter.default_value));
      if (!rule->required) {
        ASSERT_EQ(rule->defaults.size(), 1u);
        EXPECT_EQ(rule->defaults[0], parameter.default_value);
      }
    }
  }
}

}  // namespace
}  // namespace fascicle
