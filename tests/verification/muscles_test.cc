// The example scenes of isometric contraction, with the built-in spindle and two real muscles, brought to rest.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "tests/support/files.h"
#include "tests/support/paths.h"
#include "tests/support/scene_loader.h"
#include "tests/support/tet_scenes.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

// Reads an example scene as a user would, with copies of its data files.
std::shared_ptr<const Scene> LoadExample(const std::string& name, const std::vector<std::filesystem::path>& data) {
  const TemporaryFolder folder;
  std::filesystem::copy(ProjectRoot() / "client/examples" / name, folder.path());
  for (const auto& file : data) std::filesystem::copy(file, folder.path());
  Problems problems;
  auto scene = ReadScene(folder / name, problems);
  EXPECT_TRUE(scene != nullptr) << problems.ToString();
  return scene;
}

// Mean position of a region.
Vec3 CentreOf(const std::vector<Vec3>& positions, const Region& region) {
  Vec3 sum = Vec3::Zero();
  for (const std::int32_t n : region.nodes) sum += positions[n];
  return sum / static_cast<double>(region.nodes.size());
}

// Area of the widest of ten slices between two points: the volume with centroids in it over its thickness [m^2].
double WidestSlice(const TetMesh& mesh, const std::vector<Vec3>& positions, const Vec3& from, const Vec3& to) {
  constexpr int kSlices = 10;
  const double length = (to - from).norm();
  const Vec3 axis = (to - from) / length;
  std::array<double, kSlices> volume = {};
  for (const Tetrahedron& tet : mesh.tetrahedra) {
    const Vec3 centroid = (positions[tet[0]] + positions[tet[1]] + positions[tet[2]] + positions[tet[3]]) / 4;
    const auto slice = static_cast<int>(std::floor(kSlices * axis.dot(centroid - from) / length));
    if (slice < 0 || slice >= kSlices) continue;
    volume[slice] += std::abs(Determinant(EdgeMatrix(positions, tet))) / 6;
  }
  return *std::max_element(volume.begin(), volume.end()) * kSlices / length;
}

// Contracts with fixed ends: comes to rest, preserves its volume, bulges, and its force increases with activation.
void CheckIsometricContraction(const Scene& scene) {
  const RunResult run = RunScene(scene, 2);
  ASSERT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded) << run.outcome.failure.message;
  const Body& body = scene.bodies[0];
  const std::string& name = body.name;
  // Settled: it ended before the duration, which requires a speed below settle_speed.
  EXPECT_LT(run.frames.back().time, scene.duration);

  EXPECT_EQ(run.Last(name + "/activation"), 1);
  EXPECT_NEAR(run.Last(name + "/volume_ratio"), 1, 0.01);
  EXPECT_GT(run.Last(name + "/min_volume_ratio"), 0);

  const Region& one = body.regions[body.constraints[0].region];
  const Region& two = body.regions[body.constraints[1].region];
  const auto reaction = [&](std::size_t frame, const Region& region) {
    const std::string prefix = name + "/reaction/" + region.name + "/";
    return Vec3(run.At(frame, prefix + "x"), run.At(frame, prefix + "y"), run.At(frame, prefix + "z"));
  };
  const Vec3 axis = (CentreOf(body.tet().mesh.nodes, two) - CentreOf(body.tet().mesh.nodes, one)).normalized();
  const std::size_t last = run.frames.size() - 1;
  const Vec3 end_force = reaction(last, two);
  // In equilibrium, with tension in the muscle: the supports pull its ends apart.
  EXPECT_LT((end_force + reaction(last, one)).norm(), 0.02 * end_force.norm());
  EXPECT_GT(end_force.dot(axis), 0.9 * end_force.norm());
  // Increases with activation: compares frames between which it rose by a tenth.
  double activation = 0, force = 0;
  int rises = 0;
  for (std::size_t k = 0; k <= last; ++k) {
    const double now = run.At(k, name + "/activation");
    if (now < activation + 0.1) continue;
    const double pull = 0.5 * (reaction(k, two) - reaction(k, one)).dot(axis);
    EXPECT_GT(pull, force) << "activation " << now;
    activation = now;
    force = pull;
    ++rises;
  }
  EXPECT_GE(rises, 5);

  const double before = WidestSlice(body.tet().mesh, body.tet().mesh.nodes, CentreOf(body.tet().mesh.nodes, one),
                                    CentreOf(body.tet().mesh.nodes, two));
  const double after = WidestSlice(body.tet().mesh, run.frames.back().bodies[0].positions,
                                   CentreOf(body.tet().mesh.nodes, one), CentreOf(body.tet().mesh.nodes, two));
  EXPECT_GT(after, 1.02 * before);
  std::printf(
      "%s: at rest at %.3f s, %lld steps, step %.3g s, end force %.2f N, volume ratio %.5f (least of an element %.3f), "
      "widest slice %.3f -> %.3f cm^2\n",
      name.c_str(), run.frames.back().time, static_cast<long long>(run.frames.back().step), run.Last("solver/step"),
      end_force.norm(), run.Last(name + "/volume_ratio"), run.Last(name + "/min_volume_ratio"), 1e4 * before,
      1e4 * after);
}

TEST(MusclesTest, Fusiform) {
  const auto scene = LoadExample("fusiform_isometric.json", {});
  ASSERT_NE(scene, nullptr);
  CheckIsometricContraction(*scene);
}

TEST(MusclesTest, Biceps) {
  const auto mesh = DataFolder() / "opendihu_upper_arm/biceps_coarse.msh";
  if (!std::filesystem::exists(mesh)) GTEST_SKIP() << "no real anatomy in " << DataFolder() << " (set FASCICLE_DATA)";
  const auto scene = LoadExample("biceps_isometric.json", {mesh});
  ASSERT_NE(scene, nullptr);
  CheckIsometricContraction(*scene);
}

TEST(MusclesTest, BicepsFemoris) {
  const auto mesh = DataFolder() / "vh_muscle_tets/VHM_Left_Muscle_BicepsFemorisLongus.msh";
  if (!std::filesystem::exists(mesh)) GTEST_SKIP() << "no real anatomy in " << DataFolder() << " (set FASCICLE_DATA)";
  auto fibres = mesh;
  const auto scene = LoadExample("biceps_femoris_isometric.json", {mesh, fibres.replace_extension(".fibres.txt")});
  ASSERT_NE(scene, nullptr);
  CheckIsometricContraction(*scene);
}

// Tendon at both ends and aponeuroses: the part of the scene in which the muscle is activated at constant length.
void CheckTendonScene(const std::string& muscle) {
  const auto mesh = DataFolder() / ("opendihu_upper_arm/" + muscle + "_coarse.msh");
  if (!std::filesystem::exists(mesh)) GTEST_SKIP() << "no real anatomy in " << DataFolder() << " (set FASCICLE_DATA)";
  const auto loaded = LoadExample(muscle + "_tendon.json", {mesh});
  ASSERT_NE(loaded, nullptr);
  Scene scene = *loaded;
  scene.duration = 1;
  std::array<std::size_t, 2> elements = {};  // of muscle and of tendon
  for (const std::int32_t m : scene.bodies[0].tet().materials.of) ++elements[m == 0 ? 0 : 1];
  EXPECT_GT(elements[1], 0.05 * static_cast<double>(elements[0]));
  const RunResult run = RunScene(scene, 2);
  ASSERT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded) << run.outcome.failure.message;
  double before = -1, iterations = 0;
  for (std::size_t k = 0; k < run.frames.size(); ++k) {
    EXPECT_NEAR(run.At(k, muscle + "/volume_ratio"), 1, 0.005) << run.frames[k].time;
    iterations += run.At(k, "solver/iterations");
    const double pull = run.At(k, muscle + "/reaction/proximal/z");
    for (const char* axis : {"x", "y", "z"}) {
      const double sum =
          run.At(k, muscle + "/reaction/proximal/" + axis) + run.At(k, muscle + "/reaction/distal/" + axis);
      EXPECT_LT(std::abs(sum), 1e-5 * std::max(1.0, std::abs(pull)));
    }
    EXPECT_GT(pull, before) << "rises with activation";
    before = pull;
  }
  std::printf("%s with tendon: %.1f N at full activation, volume ratio %.5f, %.0f iterations\n", muscle.c_str(), before,
              run.Last(muscle + "/volume_ratio"), iterations);
}

TEST(MusclesTest, BicepsWithTendon) { CheckTendonScene("biceps"); }
TEST(MusclesTest, TricepsWithTendon) { CheckTendonScene("triceps"); }

}  // namespace
}  // namespace fascicle
