#include "core/eulerian/state.h"

namespace fascicle {

void EulerianState::Save(ArchiveWriter& archive) const {
  archive.PutDouble("time", time);
  archive.PutInt("step", step);
  archive.PutVectors("X", X);
  archive.PutVectors("v", v);
  const std::vector<std::int32_t> numbers(known.begin(), known.end());
  archive.PutInts("known", numbers);
}

void EulerianState::Load(ArchiveReader& archive) {
  time = archive.GetDouble("time");
  step = archive.GetInt("step");
  archive.GetVectors("X", std::span(X));
  archive.GetVectors("v", std::span(v));
  std::vector<std::int32_t> numbers(known.begin(), known.end());
  archive.GetInts("known", std::span(numbers));
  for (std::size_t n = 0; n < known.size(); ++n) known[n] = numbers[n] != 0 ? 1 : 0;
}

}  // namespace fascicle
