// The arm of OpenSim's examples against published and independent results.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>
#include <sstream>

#include "client/import/osim_import.h"
#include "client/import/osim_reader.h"
#include "core/skeleton/force_distribution.h"
#include "core/skeleton/forward_dynamics.h"
#include "core/skeleton/low_pass.h"
#include "core/skeleton/motion_table.h"
#include "core/skeleton/muscle_path.h"
#include "core/skeleton/skeleton_mechanics.h"
#include "server/translate/translate.h"
#include "tests/support/paths.h"

namespace fascicle {
namespace {

constexpr double kRadiansPerDegree = std::numbers::pi / 180;

std::string Contents(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

class Arm26Test : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = testing::DataFolder() / "opensim_arm26";
    if (!std::filesystem::exists(folder_)) GTEST_SKIP() << "there is no " << folder_;
    Problems problems;
    const auto model = client::ReadOsim(Contents(folder_ / "arm26.osim"), "arm26.osim", problems);
    ASSERT_TRUE(model) << problems.ToString();
    for (const client::Notice& notice : model->notices)
      std::printf("%s: %s\n", notice.where.c_str(), notice.message.c_str());
    skeleton_ = model->skeleton;
  }

  MotionTable Table(const std::string& name) {
    Problems problems;
    const auto table = ReadMotionTable(Contents(folder_ / name), name, problems);
    EXPECT_TRUE(table) << problems.ToString();
    return table.value_or(MotionTable());
  }

  std::filesystem::path folder_;
  Skeleton skeleton_;
};

TEST_F(Arm26Test, IsReadWhole) {
  EXPECT_EQ(skeleton_.bones.size(), 3u);
  EXPECT_EQ(skeleton_.joints.size(), 3u);
  EXPECT_EQ(skeleton_.coordinates.size(), 2u);
  EXPECT_EQ(skeleton_.muscles.size(), 6u);
}

TEST_F(Arm26Test, MomentArmsAndLengthsOfTheElbow) {
  std::ifstream in(testing::DataFolder() / "reference_curves/arm26_elbow_moment_arms.csv");
  std::string line;
  std::getline(in, line);
  const std::array<const char*, 6> names = {"BIClong", "BICshort", "BRA", "TRIlong", "TRIlat", "TRImed"};
  SkeletonMechanics mechanics(skeleton_);
  const int elbow = IndexOf(skeleton_.coordinates, "r_elbow_flex");
  std::array<double, 6> arm_error = {}, length_error = {}, first = {};
  int rows = 0;
  for (; std::getline(in, line); ++rows) {
    std::stringstream words(line);
    std::vector<double> values;
    for (std::string word; std::getline(words, word, ',');) values.push_back(std::stod(word));
    Eigen::VectorXd q = mechanics.StartCoordinates();
    q[elbow] = values[0] * kRadiansPerDegree;
    const MuscleGeometry geometry = GeometryOf(mechanics, q);
    for (std::size_t m = 0; m < 6; ++m) {
      const int muscle = IndexOf(skeleton_.muscles, names[m]);
      arm_error[m] += std::pow(geometry.moment_arms(elbow, muscle) - values[1 + m], 2);
      // The table leaves out what wraps at the shoulder, which is the same in all rows.
      const double difference = geometry.lengths[muscle] - values[7 + m];
      if (rows == 0) first[m] = difference;
      length_error[m] = std::max(length_error[m], std::abs(difference - first[m]));
    }
  }
  ASSERT_GT(rows, 20);
  for (std::size_t m = 0; m < 6; ++m) {
    std::printf("%-9s moment arm %.4f mm rms, length %.4f mm (constant difference %.3f mm)\n", names[m],
                1e3 * std::sqrt(arm_error[m] / rows), 1e3 * length_error[m], 1e3 * first[m]);
    EXPECT_LT(std::sqrt(arm_error[m] / rows), 0.5e-3) << names[m];
    EXPECT_LT(length_error[m], 0.5e-3) << names[m];
  }
}

// The derivative of the length is the moment arm, in every coordinate.
TEST_F(Arm26Test, MomentArmsAreSlopesOfLengths) {
  SkeletonMechanics mechanics(skeleton_);
  constexpr double kStep = 1e-6;
  for (const double elbow : {0.1, 0.6, 1.3, 2.0}) {
    const Eigen::VectorXd q = Eigen::Vector2d(0.4, elbow);
    const MuscleGeometry here = GeometryOf(mechanics, q);
    for (Eigen::Index k = 0; k < q.size(); ++k) {
      Eigen::VectorXd ahead = q, back = q;
      ahead[k] += kStep;
      back[k] -= kStep;
      const Eigen::VectorXd slope =
          (GeometryOf(mechanics, ahead).lengths - GeometryOf(mechanics, back).lengths) / (2 * kStep);
      EXPECT_LT((slope + here.moment_arms.row(k).transpose()).cwiseAbs().maxCoeff(), 1e-8) << elbow;
    }
  }
}

// The flexion without what is faster than 6 Hz, and its derivatives.
struct FilteredMotion {
  std::vector<ScalarFunction> curves;  // of each coordinate

  Eigen::VectorXd At(double time, int derivative) const {
    Eigen::VectorXd values(static_cast<Eigen::Index>(curves.size()));
    for (Eigen::Index k = 0; k < values.size(); ++k)
      values[k] = curves[static_cast<std::size_t>(k)].At(time, derivative);
    return values;
  }
};

FilteredMotion Filtered(const MotionTable& motion, const Skeleton& skeleton) {
  const double interval = (motion.times.back() - motion.times.front()) / static_cast<double>(motion.times.size() - 1);
  FilteredMotion result;
  for (const Coordinate& coordinate : skeleton.coordinates) {
    std::vector<double> angles = *motion.Find(coordinate.name);
    for (double& angle : angles) angle *= kRadiansPerDegree;
    result.curves.push_back(ScalarFunction::Cubic(motion.times, LowPass(angles, interval, 6)));
  }
  return result;
}

TEST_F(Arm26Test, InverseDynamicsOfTheFlexion) {
  const MotionTable published = Table("reference/arm26_InverseDynamics_filtered.sto");
  const FilteredMotion motion = Filtered(Table("motion/arm26_InverseKinematics.mot"), skeleton_);
  SkeletonMechanics mechanics(skeleton_);
  for (std::size_t c = 0; c < skeleton_.coordinates.size(); ++c) {
    const std::vector<double>& moments = *published.Find(skeleton_.coordinates[c].name + "_moment");
    double square = 0, peak = 0;
    for (std::size_t k = 0; k < published.times.size(); ++k) {
      const double t = published.times[k];
      const double moment =
          mechanics.InverseDynamics(motion.At(t, 0), motion.At(t, 1), motion.At(t, 2))[static_cast<Eigen::Index>(c)];
      square += std::pow(moment - moments[k], 2);
      peak = std::max(peak, std::abs(moments[k]));
    }
    const double rms = std::sqrt(square / static_cast<double>(published.times.size()));
    std::printf("%s: rms %.4f N m, %.2f %% of the peak %.3f N m\n", skeleton_.coordinates[c].name.c_str(), rms,
                100 * rms / peak, peak);
    EXPECT_LT(rms, 0.02 * peak);
  }
}

TEST_F(Arm26Test, ActivationsOfTheFlexion) {
  const MotionTable published = Table("reference/arm26_StaticOptimization_Nonphysiological_activation.sto");
  const FilteredMotion motion = Filtered(Table("motion/arm26_InverseKinematics.mot"), skeleton_);
  SkeletonMechanics mechanics(skeleton_);
  ForceDistributor distributor;
  const std::size_t muscles = skeleton_.muscles.size();
  Eigen::VectorXd strength(static_cast<Eigen::Index>(muscles));
  for (std::size_t m = 0; m < muscles; ++m) {
    strength[static_cast<Eigen::Index>(m)] = skeleton_.muscles[m].max_isometric_force;
  }
  std::vector<double> square(muscles, 0);
  for (std::size_t k = 0; k < published.times.size(); ++k) {
    const double t = published.times[k];
    const Eigen::VectorXd demand = mechanics.InverseDynamics(motion.At(t, 0), motion.At(t, 1), motion.At(t, 2));
    const MuscleGeometry geometry = GeometryOf(mechanics, motion.At(t, 0));
    const Distribution found = distributor.Solve(geometry.moment_arms * strength.asDiagonal(), demand);
    EXPECT_TRUE(found.feasible) << t;
    for (std::size_t m = 0; m < muscles; ++m) {
      const double a = (*published.Find(skeleton_.muscles[m].name))[k];
      square[m] += std::pow(found.activations[static_cast<Eigen::Index>(m)] - a, 2);
    }
  }
  for (std::size_t m = 0; m < muscles; ++m) {
    const double rms = std::sqrt(square[m] / static_cast<double>(published.times.size()));
    std::printf("%-9s rms of the activation %.5f\n", skeleton_.muscles[m].name.c_str(), rms);
    EXPECT_LT(rms, 0.03) << skeleton_.muscles[m].name;
  }
}

// The tendons' forces of the published states. Those of the long head of biceps depend on a wrap that the published
// program approximates.
TEST_F(Arm26Test, TendonForcesOfPublishedStates) {
  const MotionTable states = Table("reference/arm26_CMC_states.sto");
  const MotionTable forces = Table("reference/arm26_CMC_Actuation_force.sto");
  // The published run is by an early version.
  for (LineMuscle& muscle : skeleton_.muscles) muscle.hill.is_early = true;
  SkeletonMechanics mechanics(skeleton_);
  ForwardDynamics dynamics(mechanics, {});
  std::vector<double> largest(6, 0);
  for (std::size_t row = 0; row < states.times.size(); row += 10) {
    SkeletonState state{states.times[row], Eigen::VectorXd(2), Eigen::VectorXd::Zero(2), Eigen::VectorXd(6),
                        Eigen::VectorXd(6)};
    for (std::size_t k = 0; k < 2; ++k) {
      state.q[static_cast<Eigen::Index>(k)] = (*states.Find(skeleton_.coordinates[k].name))[row];
    }
    for (std::size_t m = 0; m < 6; ++m) {
      state.fibre_lengths[static_cast<Eigen::Index>(m)] =
          (*states.Find(skeleton_.muscles[m].name + ".fiber_length"))[row];
    }
    const Eigen::VectorXd computed = dynamics.TendonForces(state);
    for (std::size_t m = 0; m < 6; ++m) {
      const auto published = ScalarFunction::PiecewiseLinear(forces.times, *forces.Find(skeleton_.muscles[m].name));
      const double force = published.At(state.time);
      largest[m] = std::max(largest[m], std::abs(computed[static_cast<Eigen::Index>(m)] / force - 1));
    }
  }
  for (std::size_t m = 0; m < 6; ++m) {
    std::printf("%-9s force within %.3f %%\n", skeleton_.muscles[m].name.c_str(), 100 * largest[m]);
    EXPECT_LT(largest[m], 0.01) << skeleton_.muscles[m].name;
  }
}

// The scene that `fascicle import` makes of the model is translated to the same skeleton.
TEST_F(Arm26Test, TheImportedSceneIsTheModel) {
  client::OsimOptions options;
  options.accept_loss = true;
  options.motion = client::ImportedFile{"flexion.mot", Contents(folder_ / "motion/arm26_InverseKinematics.mot")};
  Problems problems;
  auto imported = client::ImportOsim(Contents(folder_ / "arm26.osim"), options, problems);
  ASSERT_TRUE(imported) << problems.ToString();
  const std::string digest(64, 'a');
  imported->scene.mutable_skeleton()->mutable_motion()->mutable_file()->set_asset("assets/" + digest);
  const auto scene = server::TranslateScene(
      imported->scene, [&](const std::string&) { return imported->files.back().bytes; }, problems);
  ASSERT_TRUE(scene) << problems.ToString();
  SkeletonMechanics own(skeleton_), translated(scene->skeleton->skeleton);
  for (const double elbow : {0.0, 0.7, 1.4, 2.2}) {
    const Eigen::VectorXd q = Eigen::Vector2d(0.4, elbow);
    const MuscleGeometry a = GeometryOf(own, q), b = GeometryOf(translated, q);
    EXPECT_LT((a.lengths - b.lengths).norm(), 1e-9) << elbow;
    EXPECT_LT((a.moment_arms - b.moment_arms).norm(), 1e-9) << elbow;
    const Eigen::VectorXd rates = Eigen::Vector2d(1, -2), accelerations = Eigen::Vector2d(3, 4);
    EXPECT_LT(
        (own.InverseDynamics(q, rates, accelerations) - translated.InverseDynamics(q, rates, accelerations)).norm(),
        1e-9);
  }
  // Activations of its motion, which the import filters as the published one was.
  const MotionTable published = Table("reference/arm26_StaticOptimization_Nonphysiological_activation.sto");
  const double start = Table("motion/arm26_InverseKinematics.mot").times[0];
  for (std::size_t m = 0; m < 6; ++m) {
    double square = 0;
    for (std::size_t k = 0; k < published.times.size(); ++k) {
      const double time = published.times[k] - start;
      square += std::pow(scene->skeleton->activations[m].At(time) - (*published.Find(skeleton_.muscles[m].name))[k], 2);
    }
    const double rms = std::sqrt(square / static_cast<double>(published.times.size()));
    std::printf("%-9s rms of the scene's activation %.5f\n", skeleton_.muscles[m].name.c_str(), rms);
    EXPECT_LT(rms, 0.03);
  }
}

// Without muscles, the arm swings as a double pendulum: its energy stays.
TEST_F(Arm26Test, AFreeArmKeepsItsEnergy) {
  skeleton_.muscles.clear();
  SkeletonMechanics mechanics(skeleton_);
  ForwardDynamics dynamics(
      mechanics,
      [](double) {
        return SkeletonInput{Eigen::VectorXd(0), Eigen::VectorXd::Zero(2)};
      },
      1e-9);
  SkeletonState state{0, Eigen::Vector2d(1, 0.5), Eigen::Vector2d::Zero(), Eigen::VectorXd(0), Eigen::VectorXd(0)};
  const double start = mechanics.Energy(state.q, state.rates);
  double swing = 0, drift = 0;
  for (int k = 1; k <= 200; ++k) {
    ASSERT_TRUE(dynamics.Advance(0.05 * k, state));
    drift = std::max(drift, std::abs(mechanics.Energy(state.q, state.rates) - start));
    swing = std::max(swing, mechanics.Energy(state.q, state.rates) - mechanics.Energy(state.q, 0 * state.rates));
  }
  std::printf("energy within %.1e of the largest kinetic energy over 10 s\n", drift / swing);
  EXPECT_LT(drift, 1e-6 * swing);
}

// Torques that balance muscles and gravity hold the arm; inverse dynamics gives them.
TEST_F(Arm26Test, HeldInEquilibriumNothingMoves) {
  SkeletonMechanics mechanics(skeleton_);
  const Eigen::VectorXd q = Eigen::Vector2d(0.3, 1.2), zero = Eigen::Vector2d::Zero();
  const Eigen::VectorXd activations = Eigen::VectorXd::Constant(6, 0.2);
  Eigen::VectorXd holding = zero;
  ForwardDynamics dynamics(
      mechanics,
      [&](double) {
        return SkeletonInput{activations, holding};
      },
      1e-8);
  SkeletonState state = dynamics.Equilibrium(q, activations);
  holding =
      mechanics.InverseDynamics(q, zero, zero) - GeometryOf(mechanics, q).moment_arms * dynamics.TendonForces(state);
  ASSERT_TRUE(dynamics.Advance(0.5, state));
  EXPECT_LT((state.q - q).norm(), 1e-6);
}

}  // namespace
}  // namespace fascicle
