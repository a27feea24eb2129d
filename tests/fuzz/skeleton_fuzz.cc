// Any bytes as an OpenSim model, or after a first byte of 1 as a motion. The result of a model is a scene that obeys
// the rules, or problems; that of a motion is a table whose columns have as many values as there are times.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "client/import/osim_import.h"
#include "core/base/check.h"
#include "core/skeleton/motion_table.h"
#include "proto/rules/field_rules.h"

namespace fascicle {
namespace {

void ReadAnything(std::string_view data) {
  if (data.empty()) return;
  Problems problems;
  if (data[0] == 1) {
    const auto table = ReadMotionTable(data.substr(1), "a.mot", problems);
    FASCICLE_CHECK(table.has_value() == problems.empty(), "a table or problems");
    if (!table) return;
    for (const auto& values : table->values) FASCICLE_CHECK(values.size() == table->times.size(), "whole columns");
    return;
  }
  client::OsimOptions options;
  options.accept_loss = (data[0] & 2) != 0;
  const auto imported = client::ImportOsim(data.substr(1), options, problems);
  FASCICLE_CHECK(imported.has_value() == problems.empty(), "a scene or problems");
  if (!imported) return;
  CheckRules(imported->scene, problems);
  FASCICLE_CHECK(problems.empty(), "the scene obeys the rules");
}

}  // namespace
}  // namespace fascicle

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fascicle::ReadAnything({reinterpret_cast<const char*>(data), size});
  return 0;
}
