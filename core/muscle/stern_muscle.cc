#include "core/muscle/stern_muscle.h"

#include <algorithm>
#include <cmath>

#include "core/materials/fibre_curves.h"
#include "core/materials/force_velocity.h"

namespace fascicle {
namespace {

constexpr double kTolerance = 1e-4;  // of the curve, relative to the peak force; as much again between samples
constexpr int kSamples = 512;        // between two points of the input curves

double ContractileLength(const SternMuscle& muscle) {
  return muscle.contractile_fraction * LengthOf(muscle, muscle.optimal_angle);
}

// The times between which both curves are smooth.
std::vector<double> Bends(const Curve& angle, const Curve& activation, double duration) {
  std::vector<double> times = {0, duration};
  for (const Curve* curve : {&angle, &activation}) {
    for (const double time : curve->times) {
      if (time > 0 && time < duration) times.push_back(time);
    }
  }
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

}  // namespace

double LengthOf(const SternMuscle& muscle, double angle) {
  const double B = muscle.origin_distance, C = muscle.insertion_distance;
  return std::sqrt(std::max(0.0, B * B + C * C - 2 * B * C * std::cos(angle)));
}

double ForceOf(const SternMuscle& muscle, double angle, double rate, double activation) {
  const double optimal = LengthOf(muscle, muscle.optimal_angle);
  const double contractile = ContractileLength(muscle);
  const double length = LengthOf(muscle, angle);
  const double stretch = (length - (optimal - contractile)) / contractile;
  // dL/dt, all of which the contractile part takes. At L = 0 both ends coincide and the force is zero.
  if (!(length > 0)) return 0;
  const double speed = muscle.origin_distance * muscle.insertion_distance * std::sin(angle) * rate / length;
  const double largest_rate = muscle.hill_rate / muscle.hill_curvature;  // maximum shortening rate: b/a [lengths/s]
  const ForceVelocityCurve force_velocity(muscle.hill_curvature, muscle.eccentric_force);
  return muscle.peak_force * ActiveCurve::Value(stretch) * force_velocity.Value(speed / contractile / largest_rate) *
         activation;
}

SternForcePoints::SternForcePoints(const SternMuscle& muscle, const SternDrive& drive, double duration)
    : muscle_(muscle), drive_(&drive), bends_(Bends(drive.angle, drive.activation, duration)) {}

bool SternForcePoints::AddNext(LineFitter& fitter) {
  if (piece_ + 1 >= bends_.size()) return false;
  // The rate of the angle, and so the force, may jump at a bend: there is a point on both sides of it.
  const double begin = bends_[piece_], end = bends_[piece_ + 1], gap = 1e-9 * (end - begin);
  const double time = std::clamp(begin + (end - begin) * sample_ / kSamples, begin, end - gap);
  const Curve& angle = drive_->angle;
  fitter.Add(time, ForceOf(muscle_, angle.At(time), angle.RateAt(time), drive_->activation.At(time)));
  if (++sample_ > kSamples) {
    sample_ = 0;
    ++piece_;
  }
  return true;
}

void SternForcePoints::Save(ArchiveWriter& archive) const {
  archive.PutInt("piece", static_cast<std::int64_t>(piece_));
  archive.PutInt("sample", sample_);
}

void SternForcePoints::Load(ArchiveReader& archive) {
  piece_ = static_cast<std::size_t>(archive.GetInt("piece"));
  sample_ = static_cast<int>(archive.GetInt("sample"));
  if (sample_ < 0 || sample_ > kSamples) archive.Fail();
}

SternForce::SternForce(const SternMuscle& muscle, const SternDrive& drive, double duration)
    : LazyCurve(SternForcePoints(muscle, drive, duration), kTolerance * muscle.peak_force) {}

}  // namespace fascicle
