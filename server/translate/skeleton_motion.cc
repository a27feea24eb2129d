#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "core/skeleton/low_pass.h"
#include "core/skeleton/motion_activations.h"
#include "core/skeleton/motion_table.h"
#include "server/translate/curves.h"
#include "server/translate/files.h"
#include "server/translate/skeleton_parts.h"
#include "server/translate/values.h"

namespace fascicle::server {
namespace {

const std::string kMotion = "skeleton.motion", kDrive = "skeleton.drive";

constexpr int kMostKeys = 10'000;
constexpr std::size_t kMostProblems = 200'000;  // times x muscles
// An angle of a file in radians beyond which it is probably in degrees [rad].
constexpr double kLargestAngle = 20;

// The name of a component in a column of a table: "/jointset/elbow/flexion/value" -> "flexion".
std::string ComponentOf(std::string column) {
  for (const std::string end : {"/value", "/activation", ".activation"}) {
    if (!column.ends_with(end)) continue;
    column.resize(column.size() - end.size());
    break;
  }
  return column.substr(column.rfind('/') + 1);
}

std::optional<MotionTable> ReadTable(const v1::FileRef& file, const std::string& path, const AssetReader& assets,
                                     Problems& problems) {
  const auto bytes = ReadFile(file, path, assets, problems);
  if (!bytes || file.path().empty()) return std::nullopt;
  return ReadMotionTable(*bytes, path + ": " + file.path(), problems);
}

std::string ListedColumns(const std::vector<std::string>& names) {
  std::string list;
  for (std::size_t k = 0; k < names.size() && k < 10; ++k)
    list += (k == 0 ? "`" : ", `") + names[k].substr(0, 64) + "`";
  return names.size() > 10 ? list + " and others" : list;
}

// Reads how coordinates change, from a file and then from keys.
class MotionReader {
 public:
  MotionReader(const v1::SkeletonMotion& wire, const Skeleton& skeleton, const SkeletonNames& names,
               std::vector<std::string>& notes, Problems& problems)
      : wire_(wire), skeleton_(skeleton), names_(names), notes_(notes), problems_(problems) {
    for (const Coordinate& coordinate : skeleton.coordinates) {
      motion_.coordinates.push_back(CoordinateMotion::Constant(coordinate.start));
    }
  }

  SkeletonMotion Read(const AssetReader& assets) {
    const std::string path = JoinPath(kMotion, "file");
    if (wire_.has_file()) {
      if (const auto table = ReadTable(wire_.file(), path, assets, problems_)) ReadColumns(*table, path);
    } else {
      for (const auto& [given, field] :
           {std::pair(wire_.has_file_start(), "file_start"), std::pair(wire_.has_low_pass(), "low_pass")}) {
        if (given) problems_.Add(JoinPath(kMotion, field), "is given without a file", "it applies to a file's motion");
      }
    }
    std::vector<bool> seen(skeleton_.coordinates.size());
    for (int i = 0; i < wire_.coordinates_size(); ++i) {
      ReadKeys(wire_.coordinates(i), JoinPath(kMotion, IndexPath("coordinates", static_cast<std::size_t>(i))), seen);
    }
    return std::move(motion_);
  }

 private:
  bool CheckFilter(const MotionTable& table) {
    if (!wire_.has_low_pass()) return true;
    const std::string path = JoinPath(kMotion, "low_pass");
    const std::vector<double>& times = table.times;
    if (!table.HasEqualIntervals()) {
      problems_.Add(path, "needs times at equal intervals", "omit it, or resample the file");
      return false;
    }
    const double most = 0.5 * static_cast<double>(times.size() - 1) / (times.back() - times.front());
    if (wire_.low_pass() < most) return true;
    problems_.Add(path,
                  "is " + Text(wire_.low_pass()) + " Hz, but the file's times allow less than " + Text(most) + " Hz",
                  "omit it, or use a lower frequency");
    return false;
  }

  void ReadColumns(const MotionTable& table, const std::string& path) {
    if (!CheckFilter(table)) return;
    const double start = wire_.has_file_start() ? wire_.file_start() : table.times.front();
    std::vector<double> times = table.times;
    for (double& time : times) time -= start;
    std::vector<std::string> ignored, held;
    for (std::size_t k = 0; k < table.columns.size(); ++k) {
      const std::string name = ComponentOf(table.columns[k]);
      const int c = table.columns[k].ends_with("/speed") ? -1 : IndexOf(skeleton_.coordinates, name);
      if (c < 0) {
        ignored.push_back(table.columns[k]);
      } else if (skeleton_.coordinates[static_cast<std::size_t>(c)].locked) {
        held.push_back(name);
      } else {
        SetColumn(table, k, c, times, path);
      }
    }
    if (ignored.size() == table.columns.size()) {
      problems_.Add(path, "has no column of a coordinate", "its columns are " + ListedColumns(ignored));
    } else if (!ignored.empty()) {
      notes_.push_back(path + ": columns that are no coordinates are ignored: " + ListedColumns(ignored));
    }
    if (!held.empty()) notes_.push_back(path + ": locked coordinates keep their values: " + ListedColumns(held));
  }

  void SetColumn(const MotionTable& table, std::size_t column, int coordinate, const std::vector<double>& times,
                 const std::string& path) {
    std::vector<double> values = table.values[column];
    const Coordinate& of = skeleton_.coordinates[static_cast<std::size_t>(coordinate)];
    if (of.is_angle && table.in_degrees) {
      for (double& value : values) value *= std::numbers::pi / 180;
    } else if (of.is_angle) {
      const double largest = std::abs(*std::max_element(values.begin(), values.end(),
                                                        [](double a, double b) { return std::abs(a) < std::abs(b); }));
      if (largest > kLargestAngle) {
        problems_.Add(
            path, "has angles of `" + of.name + "` up to " + Text(largest) + " rad, because it says " + "inDegrees=no",
            "say inDegrees=yes in its header if they are degrees");
        return;
      }
    }
    if (wire_.has_low_pass()) {
      values =
          LowPass(values, (times.back() - times.front()) / static_cast<double>(times.size() - 1), wire_.low_pass());
    }
    Set(coordinate, times, std::move(values), v1::KEY_CURVE_SPLINE);
  }

  void ReadKeys(const v1::CoordinateKeys& keys, const std::string& path, std::vector<bool>& seen) {
    Problems own;
    const int c = names_.Coordinate(keys.coordinate(), JoinPath(path, "coordinate"), own);
    if (c >= 0 && seen[static_cast<std::size_t>(c)]) {
      own.Add(JoinPath(path, "coordinate"), "has keys already", "one entry for each coordinate");
    }
    if (c >= 0 && skeleton_.coordinates[static_cast<std::size_t>(c)].locked) {
      own.Add(JoinPath(path, "coordinate"), "is locked", "unlock it, or remove its keys");
    }
    if (c >= 0) seen[static_cast<std::size_t>(c)] = true;
    CheckCount(keys.times_size(), kMostKeys, JoinPath(path, "times"), own);
    if (keys.times_size() != keys.values_size()) {
      own.Add(
          JoinPath(path, "values"),
          "has " + std::to_string(keys.values_size()) + " values for " + std::to_string(keys.times_size()) + " times",
          "one value for each time");
    }
    for (int k = 1; k < keys.times_size(); ++k) {
      if (keys.times(k) > keys.times(k - 1)) continue;
      own.Add(JoinPath(path, IndexPath("times", static_cast<std::size_t>(k))),
              "is " + Text(keys.times(k)) + " s after " + Text(keys.times(k - 1)) + " s",
              "times must increase strictly");
      break;
    }
    problems_.Append("", own);
    if (own.empty()) {
      Set(c, {keys.times().begin(), keys.times().end()}, {keys.values().begin(), keys.values().end()}, keys.curve());
    }
  }

  void Set(int coordinate, std::vector<double> times, std::vector<double> values, v1::KeyCurve curve) {
    NoteRange(skeleton_.coordinates[static_cast<std::size_t>(coordinate)], times, values);
    CoordinateMotion& motion = motion_.coordinates[static_cast<std::size_t>(coordinate)];
    motion.first = times.front();
    motion.last = times.back();
    if (times.size() == 1) {
      motion.function = ScalarFunction::Constant(values[0]);
    } else if (curve == v1::KEY_CURVE_SPLINE) {
      motion.function = ScalarFunction::Cubic(std::move(times), std::move(values));
    } else {
      motion.function = ScalarFunction::LeastJerk(std::move(times), std::move(values));
    }
  }

  void NoteRange(const Coordinate& coordinate, const std::vector<double>& times, const std::vector<double>& values) {
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (values[k] >= coordinate.range[0] && values[k] <= coordinate.range[1]) continue;
      notes_.push_back(kMotion + ": `" + coordinate.name + "` leaves its range [" + Text(coordinate.range[0]) + ", " +
                       Text(coordinate.range[1]) + "] with " + Text(values[k]) + " at " + Text(times[k]) + " s");
      return;
    }
  }

  const v1::SkeletonMotion& wire_;
  const Skeleton& skeleton_;
  const SkeletonNames& names_;
  std::vector<std::string>& notes_;
  Problems& problems_;
  SkeletonMotion motion_;
};

// Times of the key poses; empty after a problem.
std::vector<double> KeyTimes(const v1::Scene& scene, std::size_t muscles, Problems& problems) {
  const v1::ForceDistribution& wire = scene.skeleton().drive().distribution();
  const std::string path = JoinPath(kDrive, "distribution");
  std::vector<double> times(wire.times().begin(), wire.times().end());
  if (!times.empty() && wire.has_interval()) {
    problems.Add(JoinPath(path, "interval"), "is given beside times", "give one of them");
    return {};
  }
  for (std::size_t k = 1; k < times.size(); ++k) {
    if (times[k] > times[k - 1]) continue;
    problems.Add(JoinPath(path, IndexPath("times", k)), "does not increase", "times must increase strictly");
    return {};
  }
  if (times.empty()) {
    const double interval = wire.has_interval() ? wire.interval() : scene.output().frame_interval();
    if (!(interval > 0) || !(scene.duration() > 0)) return {};  // reported by the rules
    const double count = std::ceil(scene.duration() / interval * (1 - 1e-12));
    if (count > static_cast<double>(kMostProblems)) {
      problems.Add(JoinPath(path, "interval"), "is too short for the scene's duration",
                   "at most 200,000 times x muscles");
      return {};
    }
    for (int k = 0; k <= static_cast<int>(count); ++k) times.push_back(std::min(k * interval, scene.duration()));
  }
  if (times.size() * muscles > kMostProblems) {
    problems.Add(path, "has " + std::to_string(times.size()) + " times and " + std::to_string(muscles) + " muscles",
                 "at most 200,000 times x muscles: use a longer interval");
    return {};
  }
  return times;
}

void NoteLack(const Skeleton& skeleton, const MotionActivations& found, const std::vector<double>& times,
              std::vector<std::string>& notes) {
  for (Eigen::Index c = 0; c < found.lack.rows(); ++c) {
    Eigen::Index at = 0;
    const double most = found.lack.row(c).cwiseAbs().maxCoeff(&at);
    if (!(most > 1e-6 * found.torques.row(c).cwiseAbs().maxCoeff())) continue;
    const Coordinate& coordinate = skeleton.coordinates[static_cast<std::size_t>(c)];
    char text[64];
    std::snprintf(text, sizeof text, "%.4g of %.4g %s", std::abs(found.lack(c, at)), std::abs(found.torques(c, at)),
                  coordinate.is_angle ? "N m" : "N");
    notes.push_back(kDrive + ".distribution: muscles lack up to " + text + " about `" + coordinate.name + "`, at " +
                    Text(times[static_cast<std::size_t>(at)]) +
                    " s; their activations are those whose torques are nearest");
  }
}

std::vector<Curve> Distributed(const v1::Scene& scene, SkeletonMechanics& mechanics, const SkeletonMotion& motion,
                               MuscleStrength strength, const TranslateTools& tools, std::vector<std::string>& notes,
                               Problems& problems) {
  const Skeleton& skeleton = mechanics.skeleton();
  const v1::ForceDistribution& wire = scene.skeleton().drive().distribution();
  const std::vector<double> times = KeyTimes(scene, skeleton.muscles.size(), problems);
  std::vector<Curve> curves(skeleton.muscles.size(), Curve::Constant(0));
  if (times.empty()) return curves;
  const MotionActivations found = ActivationsOf(mechanics, motion, strength, times, wire.at_rest(), tools.stop);
  NoteLack(skeleton, found, times, notes);
  for (std::size_t m = 0; m < curves.size(); ++m) {
    curves[m].times = times;
    curves[m].interpolation = InterpolationOf(wire.interpolation());
    curves[m].values.resize(times.size());
    for (std::size_t k = 0; k < times.size(); ++k) {
      curves[m].values[k] = found.activations(static_cast<Eigen::Index>(m), static_cast<Eigen::Index>(k));
    }
  }
  return curves;
}

void SetGivenCurves(const v1::MuscleCurves& wire, const SkeletonNames& names, std::vector<Curve>& curves,
                    Problems& problems) {
  std::vector<bool> seen(curves.size());
  for (int i = 0; i < wire.curves_size(); ++i) {
    const std::string path = JoinPath(kDrive, IndexPath("curves.curves", static_cast<std::size_t>(i)));
    const auto muscle = names.muscles.Find(wire.curves(i).muscle(), JoinPath(path, "muscle"), problems);
    if (!wire.curves(i).has_curve()) problems.Add(JoinPath(path, "curve"), "is missing", "give times [s] and values");
    const Curve curve = TranslateCurve(wire.curves(i).curve(), kActivationCurve, JoinPath(path, "curve"), problems);
    if (!muscle) continue;
    if (seen[*muscle]) problems.Add(JoinPath(path, "muscle"), "has a curve already", "one curve for each muscle");
    seen[*muscle] = true;
    curves[*muscle] = curve;
  }
}

void SetCurvesOfFile(const v1::FileRef& file, const Skeleton& skeleton, const AssetReader& assets,
                     std::vector<Curve>& curves, std::vector<std::string>& notes, Problems& problems) {
  const std::string path = JoinPath(kDrive, "file");
  const auto table = ReadTable(file, path, assets, problems);
  if (!table) return;
  std::vector<std::string> ignored;
  for (std::size_t k = 0; k < table->columns.size(); ++k) {
    const int m = IndexOf(skeleton.muscles, ComponentOf(table->columns[k]));
    if (m < 0) {
      ignored.push_back(table->columns[k]);
      continue;
    }
    Curve& curve = curves[static_cast<std::size_t>(m)];
    curve.times.clear();
    for (const double time : table->times) curve.times.push_back(time - table->times.front());
    curve.values = table->values[k];
    for (double& value : curve.values) {
      if (value >= -1e-6 && value <= 1 + 1e-6) {
        value = std::clamp(value, 0.0, 1.0);  // rounded
        continue;
      }
      problems.Add(path, "has the activation " + Text(value) + " of `" + table->columns[k].substr(0, 64) + "`",
                   "activations are within [0, 1]");
      break;
    }
  }
  if (ignored.size() == table->columns.size()) {
    problems.Add(path, "has no column of a muscle", "its columns are " + ListedColumns(ignored));
  } else if (!ignored.empty()) {
    notes.push_back(path + ": columns that are no muscles are ignored: " + ListedColumns(ignored));
  }
}

}  // namespace

SkeletonMotion TranslateSkeletonMotion(const v1::Skeleton& wire, const Skeleton& skeleton, const SkeletonNames& names,
                                       const AssetReader& assets, std::vector<std::string>& notes, Problems& problems) {
  return MotionReader(wire.motion(), skeleton, names, notes, problems).Read(assets);
}

std::vector<Curve> TranslateMuscleDrive(const v1::Scene& scene, SkeletonMechanics& mechanics,
                                        const SkeletonMotion& motion, MuscleStrength strength,
                                        const SkeletonNames& names, const AssetReader& assets,
                                        const TranslateTools& tools, std::vector<std::string>& notes,
                                        Problems& problems) {
  const Skeleton& skeleton = mechanics.skeleton();
  const v1::MuscleDrive& wire = scene.skeleton().drive();
  std::vector<Curve> curves(skeleton.muscles.size(), Curve::Constant(0));
  if (wire.has_distribution()) {
    if (skeleton.muscles.empty()) problems.Add(kDrive, "the skeleton has no muscles", "remove it, or add muscles");
    return Distributed(scene, mechanics, motion, strength, tools, notes, problems);
  }
  if (wire.has_curves()) SetGivenCurves(wire.curves(), names, curves, problems);
  if (wire.has_file()) SetCurvesOfFile(wire.file(), skeleton, assets, curves, notes, problems);
  return curves;
}

}  // namespace fascicle::server
