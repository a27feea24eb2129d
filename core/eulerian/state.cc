#include "core/eulerian/state.h"

#include <span>

namespace fascicle {
namespace {

std::vector<Vec3> Columns(const std::vector<Mat3>& matrices) {
  std::vector<Vec3> columns;
  for (const Mat3& matrix : matrices) {
    for (const Vec3& column : matrix.colwise()) columns.push_back(column);
  }
  return columns;
}

std::string PrefixOf(std::size_t body) { return "body" + std::to_string(body) + "/"; }

}  // namespace

void EulerianState::Save(const std::string& prefix, ArchiveWriter& archive) const {
  archive.PutVectors(prefix + "X", X);
  archive.PutVectors(prefix + "v", v);
  const std::vector<std::int32_t> numbers(known.begin(), known.end());
  archive.PutInts(prefix + "known", numbers);
  archive.PutVectors(prefix + "surface", surface);
  archive.PutDoubles(prefix + "pressure", pressure);
  archive.PutDouble(prefix + "momentum_mass", momentum_mass);
  archive.PutVectors(prefix + "momentum", std::span(&momentum, 1));
  archive.PutVectors(prefix + "moment", std::span(&moment, 1));
  archive.PutVectors(prefix + "plastic", Columns(plastic));
  archive.PutVectors(prefix + "plastic_places", plastic_places);
  archive.PutVectors(prefix + "reactions", reactions);
  archive.PutVectors(prefix + "moments", moments);
  archive.PutVectors(prefix + "position", std::span(&pose.position, 1));
  archive.PutDoubles(prefix + "quaternion", pose.quaternion);
}

void EulerianState::Load(const std::string& prefix, ArchiveReader& archive) {
  archive.GetVectors(prefix + "X", std::span(X));
  archive.GetVectors(prefix + "v", std::span(v));
  std::vector<std::int32_t> numbers(known.begin(), known.end());
  archive.GetInts(prefix + "known", std::span(numbers));
  for (std::size_t n = 0; n < known.size(); ++n) known[n] = numbers[n] != 0 ? 1 : 0;
  archive.GetVectors(prefix + "surface", std::span(surface));
  archive.GetDoubles(prefix + "pressure", std::span(pressure));
  momentum_mass = archive.GetDouble(prefix + "momentum_mass");
  archive.GetVectors(prefix + "momentum", std::span(&momentum, 1));
  archive.GetVectors(prefix + "moment", std::span(&moment, 1));
  std::vector<Vec3> columns = Columns(plastic);
  archive.GetVectors(prefix + "plastic", std::span(columns));
  for (std::size_t k = 0; k < columns.size(); ++k) plastic[k / 3].col(static_cast<Eigen::Index>(k % 3)) = columns[k];
  archive.GetVectors(prefix + "plastic_places", std::span(plastic_places));
  archive.GetVectors(prefix + "reactions", std::span(reactions));
  archive.GetVectors(prefix + "moments", std::span(moments));
  archive.GetVectors(prefix + "position", std::span(&pose.position, 1));
  archive.GetDoubles(prefix + "quaternion", std::span(pose.quaternion));
}

void EulerianWorldState::Save(ArchiveWriter& archive) const {
  archive.PutDouble("time", time);
  archive.PutInt("step", step);
  archive.PutDouble("time_step", time_step);
  archive.PutInt("iterations", iterations);
  for (std::size_t b = 0; b < bodies.size(); ++b) bodies[b].Save(PrefixOf(b), archive);
  if (!floor_forces.empty()) archive.PutVectors("floor_forces", floor_forces);
}

void EulerianWorldState::Load(ArchiveReader& archive) {
  time = archive.GetDouble("time");
  step = archive.GetInt("step");
  time_step = archive.GetDouble("time_step");
  iterations = archive.GetInt("iterations");
  for (std::size_t b = 0; b < bodies.size(); ++b) bodies[b].Load(PrefixOf(b), archive);
  if (!floor_forces.empty()) archive.GetVectors("floor_forces", std::span(floor_forces));
}

}  // namespace fascicle
