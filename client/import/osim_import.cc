#include "client/import/osim_import.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "client/import/encode_skeleton.h"
#include "client/import/losses.h"
#include "client/import/osim_reader.h"
#include "core/geometry/triangle_mesh.h"
#include "core/skeleton/motion_table.h"
#include "proto/rules/field_rules.h"

namespace fascicle::client {
namespace {

constexpr std::size_t kMaxModelBytes = std::size_t{64} << 20, kMaxMotionBytes = std::size_t{256} << 20;
constexpr double kFrames = 50;          // of a motion
constexpr double kMostDuration = 1000;  // of a scene [s]

// The last part of a path, in the style of any system.
std::string FileName(const std::string& path) { return path.substr(path.find_last_of("/\\") + 1); }

class OsimImporter {
 public:
  OsimImporter(const OsimOptions& options, OsimModel model, Problems& problems)
      : options_(options), model_(std::move(model)), problems_(problems) {
    result_.notices = std::move(model_.notices);
    result_.units = "m-N-s";
    result_.version = "OpenSim";
  }

  std::optional<ImportedScene> Make() {
    TakeSurfaces();
    v1::Scene& scene = result_.scene;
    scene.set_name(model_.skeleton.name.empty() ? FileName(options_.name) : model_.skeleton.name.substr(0, 200));
    std::vector<std::string> renamed;
    *scene.mutable_skeleton() = EncodeSkeleton(model_.skeleton, renamed);
    for (const std::string& name : renamed) Note(name);
    NoteStrength();
    const Vec3& g = model_.skeleton.gravity;
    if (!g.isZero(0)) scene.mutable_gravity()->mutable_acceleration()->Assign(g.begin(), g.end());
    scene.set_duration(1);
    if (options_.motion) TakeMotion(*options_.motion);
    scene.mutable_output()->set_frame_interval(scene.duration() / kFrames);
    scene.mutable_tet();
    CheckResult();
    if (!options_.accept_loss) RefuseLosses(result_.notices, problems_);
    return std::move(result_);
  }

 private:
  void Note(std::string message) {
    result_.notices.push_back({Notice::Kind::kNote, 0, options_.name, std::move(message), {}});
  }

  // Keeps the surfaces whose files exist and can be read.
  void TakeSurfaces() {
    std::map<std::string, bool> taken;
    for (Bone& bone : model_.skeleton.bones) {
      std::vector<BoneSurface> kept;
      for (BoneSurface& surface : bone.surfaces) {
        const std::string name = FileName(surface.file);
        const auto [known, is_new] = taken.try_emplace(name, false);
        if (is_new) known->second = TakeFile(surface.file, name);
        if (!known->second) continue;
        surface.file = name;
        kept.push_back(std::move(surface));
      }
      bone.surfaces = std::move(kept);
    }
  }

  bool TakeFile(const std::string& path, const std::string& name) {
    std::optional<std::string> bytes = options_.surface ? options_.surface(path) : std::nullopt;
    if (!bytes) {
      Note("the surface " + path + " is not drawn: there is no such file beside the model or in its folder Geometry");
      return false;
    }
    Problems own;
    if (!ReadSurface(name, *bytes, own)) {
      Note("the surface " + path + " is not drawn: " + (own.empty() ? "" : own.kept()[0].message));
      return false;
    }
    result_.files.push_back({name, *std::move(bytes)});
    return true;
  }

  void TakeMotion(const ImportedFile& motion) {
    if (motion.bytes.size() > kMaxMotionBytes) {
      problems_.Add(motion.name, "is larger than 256 MiB");
      return;
    }
    const auto table = ReadMotionTable(motion.bytes, motion.name, problems_);
    if (!table) return;
    v1::Scene& scene = result_.scene;
    v1::SkeletonMotion& wire = *scene.mutable_skeleton()->mutable_motion();
    const std::string name = FileName(motion.name);
    wire.mutable_file()->set_path(name);
    const double length = table->times.back() - table->times.front();
    if (length > 0) scene.set_duration(std::min(length, kMostDuration));
    if (length > kMostDuration) Note("the motion is cut after 1000 s, the longest that a scene may last");
    CheckColumns(*table);
    const double fastest = 0.5 * static_cast<double>(table->times.size() - 1) / std::max(length, 1e-9);
    const bool can_filter = options_.low_pass < fastest && table->HasEqualIntervals();
    if (options_.low_pass > 0 && !can_filter) {
      Note("the motion is not filtered: that needs rows at equal intervals, more than two in a period");
    } else if (options_.low_pass > 0) {
      wire.set_low_pass(options_.low_pass);
      Note("what is faster than " + std::to_string(options_.low_pass).substr(0, 4) +
           " Hz is removed from the motion: `skeleton.motion.low_pass`");
    }
    if (!model_.skeleton.muscles.empty()) scene.mutable_skeleton()->mutable_drive()->mutable_distribution();
    result_.files.push_back({name, motion.bytes});
  }

  // The motion's file is taken as it is, so its columns must have the names that the scene gives to coordinates.
  void CheckColumns(const MotionTable& table) {
    for (const Coordinate& coordinate : model_.skeleton.coordinates) {
      if (SceneName(coordinate.name) == coordinate.name || !table.Find(coordinate.name)) continue;
      problems_.Add(options_.motion->name, "has the coordinate `" + coordinate.name + "`, not a name in a scene",
                    "use letters, digits, `_`, `-` and `.`, both in the model and in the motion");
    }
  }

  void NoteStrength() {
    const std::vector<LineMuscle>& muscles = model_.skeleton.muscles;
    const bool has_fibres = std::any_of(muscles.begin(), muscles.end(),
                                        [](const LineMuscle& muscle) { return muscle.optimal_fibre_length > 0; });
    if (has_fibres) {
      Note(
          "muscles have their largest isometric force at every length; with `skeleton.strength` = force_length it "
          "depends on the length of their fibres");
    }
  }

  // Numbers that a scene does not allow.
  void CheckResult() {
    Problems own;
    CheckRules(result_.scene, own);
    problems_.Append(options_.name, own);
  }

  const OsimOptions& options_;
  OsimModel model_;
  Problems& problems_;
  ImportedScene result_;
};

}  // namespace

std::optional<ImportedScene> ImportOsim(std::string_view bytes, const OsimOptions& options, Problems& problems) {
  Problems own;
  std::optional<ImportedScene> result;
  if (bytes.size() > kMaxModelBytes) {
    own.Add(options.name, "is larger than 64 MiB", "surfaces belong into files of their own");
  } else if (auto model = ReadOsim(bytes, options.name, own)) {
    result = OsimImporter(options, *std::move(model), own).Make();
  }
  problems.Append("", own);
  return own.empty() ? std::move(result) : std::nullopt;
}

}  // namespace fascicle::client
