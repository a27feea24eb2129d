#ifndef FASCICLE_TESTS_SUPPORT_LAW_VALUES_H_
#define FASCICLE_TESTS_SUPPORT_LAW_VALUES_H_

#include <cmath>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "core/materials/material.h"

namespace fascicle::testing {

// A usable value of a parameter without a default, of the order of soft tissue.
inline double RequiredValue(const ParameterInfo& parameter) {
  struct Value {
    std::string_view name;
    double value;
  };
  static constexpr Value kValues[] = {{"young_modulus", 2e5},
                                      {"c1", 3e4},
                                      {"bulk_modulus", 8e7},
                                      {"c3", 2e4},
                                      {"c4", 8},
                                      {"c5", 1.5e6},
                                      {"lam_max", 1.2},
                                      {"m1", 1.3},
                                      {"c", 3e4},
                                      {"k1", 2e4},
                                      {"k2", 0.5},
                                      {"gamma", 0.7}};
  for (const Value& value : kValues) {
    if (value.name == parameter.name) return value.value;
  }
  throw std::logic_error(std::string("no value for ") + parameter.name);
}

// The defaults of a law, and usable values where there is none: two families of fibres are in a plane with the x axis.
inline std::vector<double> UsableValues(const LawInfo& law) {
  std::vector<double> values;
  for (const ParameterInfo& p : law.parameters) {
    const bool reference = std::string_view(p.name) == "reference_x";
    values.push_back(reference ? 1 : std::isnan(p.default_value) ? RequiredValue(p) : p.default_value);
  }
  return values;
}

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_SUPPORT_LAW_VALUES_H_
