#include "core/eulerian/state.h"

namespace fascicle {
namespace {

std::vector<Vec3> Columns(const std::vector<Mat3>& matrices) {
  std::vector<Vec3> columns;
  for (const Mat3& matrix : matrices) {
    for (const Vec3& column : matrix.colwise()) columns.push_back(column);
  }
  return columns;
}

}  // namespace

void EulerianState::Save(ArchiveWriter& archive) const {
  archive.PutDouble("time", time);
  archive.PutInt("step", step);
  archive.PutVectors("X", X);
  archive.PutVectors("v", v);
  const std::vector<std::int32_t> numbers(known.begin(), known.end());
  archive.PutInts("known", numbers);
  archive.PutVectors("surface", surface);
  archive.PutDoubles("pressure", pressure);
  archive.PutDouble("momentum_mass", momentum_mass);
  archive.PutVectors("momentum", std::span(&momentum, 1));
  archive.PutVectors("moment", std::span(&moment, 1));
  archive.PutVectors("plastic", Columns(plastic));
  archive.PutVectors("plastic_places", plastic_places);
}

void EulerianState::Load(ArchiveReader& archive) {
  time = archive.GetDouble("time");
  step = archive.GetInt("step");
  archive.GetVectors("X", std::span(X));
  archive.GetVectors("v", std::span(v));
  std::vector<std::int32_t> numbers(known.begin(), known.end());
  archive.GetInts("known", std::span(numbers));
  for (std::size_t n = 0; n < known.size(); ++n) known[n] = numbers[n] != 0 ? 1 : 0;
  archive.GetVectors("surface", std::span(surface));
  archive.GetDoubles("pressure", std::span(pressure));
  momentum_mass = archive.GetDouble("momentum_mass");
  archive.GetVectors("momentum", std::span(&momentum, 1));
  archive.GetVectors("moment", std::span(&moment, 1));
  std::vector<Vec3> columns = Columns(plastic);
  archive.GetVectors("plastic", std::span(columns));
  for (std::size_t k = 0; k < columns.size(); ++k) plastic[k / 3].col(static_cast<Eigen::Index>(k % 3)) = columns[k];
  archive.GetVectors("plastic_places", std::span(plastic_places));
}

}  // namespace fascicle
