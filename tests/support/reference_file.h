#ifndef FASCICLE_TESTS_SUPPORT_REFERENCE_FILE_H_
#define FASCICLE_TESTS_SUPPORT_REFERENCE_FILE_H_

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "tests/support/paths.h"

namespace fascicle::testing {

// One of the FEBio reference results; none if it is absent.
inline std::optional<nlohmann::json> ReadReference(const std::string& name) {
  std::ifstream file(ReferenceFolder() / "febio" / (name + ".json"));
  if (!file) return std::nullopt;
  return nlohmann::json::parse(file);
}

inline std::string NoReference() {
  return "no reference results in " + ReferenceFolder().string() + " (set FASCICLE_REFERENCE)";
}

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_SUPPORT_REFERENCE_FILE_H_
