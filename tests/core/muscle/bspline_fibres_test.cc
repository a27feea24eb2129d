#include "core/muscle/bspline_fibres.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numbers>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "core/geometry/bspline_fit.h"
#include "core/geometry/mesh_io.h"
#include "core/geometry/region.h"
#include "core/geometry/shapes.h"
#include "core/muscle/muscle_solid.h"
#include "tests/support/files.h"
#include "tests/support/nodes_where.h"
#include "tests/support/paths.h"

namespace fascicle {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr double kDegree = std::numbers::pi / 180;

double AngleOfLines(const Vec3& a, const Vec3& b) { return std::acos(std::min(1.0, std::abs(a.dot(b)))); }

struct Angles {
  double mean = 0, p95 = 0;  // by volume [rad]
};

Angles Between(const TetMesh& mesh, const FibreField& a, const FibreField& b) {
  std::vector<std::pair<double, double>> angles;
  double volume = 0, sum = 0;
  for (std::size_t e = 0; e < a.size(); ++e) {
    angles.emplace_back(AngleOfLines(a[e], b[e]), SignedVolume(mesh, e));
    volume += angles.back().second;
    sum += angles.back().first * angles.back().second;
  }
  std::sort(angles.begin(), angles.end());
  Angles result{sum / volume, 0};
  double below = 0;
  for (std::size_t i = 0; i < angles.size() && below < 0.95 * volume; ++i) {
    below += angles[i].second;
    result.p95 = angles[i].first;
  }
  return result;
}

// --- Known solids ----------------------------------------------------------------------------------------------------

// A solid that approximates `map` on the unit cube to 1e-7.
BsplineLocator SolidOf(const std::function<Vec3(const Vec3&)>& map) {
  constexpr int kSamples = 18;
  std::vector<SolidSample> samples;
  for (int k = 0; k <= kSamples; ++k) {
    for (int j = 0; j <= kSamples; ++j) {
      for (int i = 0; i <= kSamples; ++i) {
        const Vec3 p = Vec3(i, j, k) / kSamples;
        samples.push_back({p, map(p)});
      }
    }
  }
  const BsplineBasis across = BsplineBasis::Uniform(3, 5), along = BsplineBasis::Uniform(5, 12);
  auto fit = FitBsplineSolid({across, across, along}, samples, 1e-12);
  EXPECT_TRUE(fit);
  EXPECT_LE(fit->max, 1e-7);
  return BsplineLocator(std::move(fit->solid));
}

// The unit cube with its coordinates as parameters, bent by `map`.
TetMesh BlockOf(const std::function<Vec3(const Vec3&)>& map) {
  TetMesh mesh = MakeBox(Vec3::Zero(), Vec3::Ones(), {5, 5, 16});
  for (Vec3& X : mesh.nodes) X = map(X);
  return mesh;
}

// A block twisted about z by 1.2 rad in a length of 3: the fibre at X is ez + (1.2 / 3) ez x X.
TEST(BsplineFibres, TwistWithATwistedBlock) {
  const auto twist = [](const Vec3& p) {
    const Eigen::Vector2d across = Eigen::Rotation2Dd(1.2 * p.z()) * Eigen::Vector2d(p.x() - 0.5, p.y() - 0.5);
    return Vec3(across.x(), across.y(), 3 * p.z());
  };
  const TetMesh mesh = BlockOf(twist);
  ThreadTeam team(2);
  Problems problems;
  const BsplineFibreField field = BsplineFibres(mesh, SolidOf(twist), team, problems);
  ASSERT_TRUE(problems.empty()) << problems.ToString();
  ASSERT_THAT(field.fibres, SizeIs(mesh.tetrahedra.size()));
  EXPECT_EQ(field.folded, 0u);
  double most = 0;
  for (std::size_t e = 0; e < field.fibres.size(); ++e) {
    const Vec3 X = Centroid(mesh, e);
    EXPECT_LE((field.fibres[e] - (Vec3::UnitZ() + 0.4 * Vec3::UnitZ().cross(X)).normalized()).norm(), 1e-5);
    most = std::max(most, AngleOfLines(field.fibres[e], Vec3::UnitZ()));
  }
  EXPECT_GT(most, 10 * kDegree);
}

// A quarter of a ring about y: fibres are its tangents.
TEST(BsplineFibres, FollowACurvedBlock) {
  const auto bend = [](const Vec3& p) {
    const double angle = p.z() * std::numbers::pi / 2, radius = 2 + p.x();
    return Vec3(radius * std::cos(angle), p.y(), radius * std::sin(angle));
  };
  const TetMesh mesh = BlockOf(bend);
  ASSERT_GT(SignedVolume(mesh, 0), 0);
  ThreadTeam team(2);
  Problems problems;
  const BsplineFibreField field = BsplineFibres(mesh, SolidOf(bend), team, problems);
  ASSERT_THAT(field.fibres, SizeIs(mesh.tetrahedra.size())) << problems.ToString();
  EXPECT_EQ(field.folded, 0u);
  // The same fibres from an inverted solid, which is reported.
  const auto mirrored = [&](const Vec3& p) { return bend({1 - p.x(), p.y(), p.z()}); };
  EXPECT_EQ(BsplineFibres(mesh, SolidOf(mirrored), team, problems).folded, mesh.tetrahedra.size());
  for (std::size_t e = 0; e < field.fibres.size(); ++e) {
    const Vec3 X = Centroid(mesh, e);
    EXPECT_LE((field.fibres[e] - Vec3(-X.z(), 0, X.x()).normalized()).norm(), 1e-5);
  }
}

// The fibres of a solid may lean to both sides of a plane: its control net has a kink there. Unit cube, x from 0 to 1;
// fibres lean away from x = 1/2 with a slope of 0.3.
TEST(BsplineFibres, LeanToBothSidesInABipennateSolid) {
  const BsplineBasis linear = BsplineBasis::Uniform(1, 2);
  std::vector<Vec3> controls;
  for (const double z : {0.0, 1.0}) {
    for (const double y : {0.0, 1.0}) {
      controls.insert(controls.end(), {Vec3(-0.3 * z, y, z), Vec3(0.5 - 0.3 * z, y, z), Vec3(0.5 + 0.3 * z, y, z),
                                       Vec3(1 + 0.3 * z, y, z)});
    }
  }
  // Between the halves there is a wedge that opens along w, which is not part of the mesh.
  const BsplineLocator locator(BsplineSolid({BsplineBasis(1, {0, 0, 1, 2, 3, 3}), linear, linear}, controls));
  TetMesh mesh = MakeBox(Vec3::Zero(), Vec3::Ones(), {4, 2, 4});
  for (Vec3& X : mesh.nodes) X.x() += X.x() <= 0.5 ? -0.3 * X.z() - 1e-3 : 0.3 * X.z() + 1e-3;
  std::erase_if(mesh.tetrahedra, [&](const Tetrahedron& tetrahedron) {
    const auto left = std::count_if(tetrahedron.begin(), tetrahedron.end(), [&](std::int32_t n) {
      return mesh.nodes[static_cast<std::size_t>(n)].x() < 0.5 - 0.3 * mesh.nodes[static_cast<std::size_t>(n)].z();
    });
    return left != 0 && left != 4;
  });
  ThreadTeam team(1);
  Problems problems;
  const BsplineFibreField field = BsplineFibres(mesh, locator, team, problems);
  ASSERT_THAT(field.fibres, SizeIs(mesh.tetrahedra.size())) << problems.ToString();
  int left = 0, right = 0;
  for (std::size_t e = 0; e < field.fibres.size(); ++e) {
    const Vec3 X = Centroid(mesh, e);
    const bool is_left = X.x() < 0.5;
    (is_left ? left : right) += 1;
    EXPECT_LE((field.fibres[e] - Vec3(is_left ? -0.3 : 0.3, 0, 1).normalized()).norm(), 1e-9) << X.transpose();
  }
  EXPECT_GT(left, 40);
  EXPECT_GT(right, 40);
}

// --- Outside ---------------------------------------------------------------------------------------------------------

class PartlyOutside : public ::testing::Test {
 protected:
  // A solid on [0, 1]^3, fibres along z.
  const BsplineLocator locator_ = SolidOf([](const Vec3& p) { return p; });
  ThreadTeam team_{2};
  Problems problems_;
};

TEST_F(PartlyOutside, IsCountedAndTakesTheNearestFibre) {
  // A quarter of the layers is beyond x = 1, with centroids up to about 1/3 - h/4.
  const TetMesh mesh = MakeBox(Vec3::Zero(), Vec3(4.0 / 3, 1, 1), {4, 2, 2});
  const BsplineFibreField field = BsplineFibres(mesh, locator_, team_, problems_);
  ASSERT_THAT(field.fibres, SizeIs(mesh.tetrahedra.size())) << problems_.ToString();
  EXPECT_EQ(field.outside, mesh.tetrahedra.size() / 4);
  double farthest = 0;
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) farthest = std::max(farthest, Centroid(mesh, e).x() - 1);
  EXPECT_NEAR(field.farthest, farthest, 1e-9);
  for (const Vec3& fibre : field.fibres) EXPECT_LE((fibre - Vec3::UnitZ()).norm(), 1e-6);
}

TEST_F(PartlyOutside, IsAProblemWhenItIsMoreThanHalf) {
  const TetMesh mesh = MakeBox(Vec3(0.6, 0, 0), Vec3::Ones(), {4, 2, 2});
  EXPECT_THAT(BsplineFibres(mesh, locator_, team_, problems_).fibres, IsEmpty());
  EXPECT_THAT(problems_.ToString(), HasSubstr("tetrahedra lie outside of the B-spline solid"));
}

TEST_F(PartlyOutside, IsAProblemWithoutLength) {
  const BsplineBasis linear = BsplineBasis::Uniform(1, 2);
  std::vector<Vec3> flat;
  for (int c = 0; c < 8; ++c) flat.emplace_back(c % 2, c / 2 % 2, 0.5);
  TetMesh mesh = MakeBox(Vec3(0, 0, 0.5), Vec3(1, 1, 1e-12), {2, 2, 1});
  EXPECT_THAT(
      BsplineFibres(mesh, BsplineLocator(BsplineSolid({linear, linear, linear}, flat)), team_, problems_).fibres,
      IsEmpty());
  EXPECT_THAT(problems_.ToString(), HasSubstr("no length along w in 24 tetrahedra"));
}

// --- Fitted solids ---------------------------------------------------------------------------------------------------

class FittedToASpindle : public ::testing::Test {
 protected:
  static constexpr double kLength = 0.2, kBelly = 0.02, kEnd = 0.008;
  const TetMesh mesh_ = MakeFusiform(
      {.length = kLength, .belly_radius = kBelly, .end_radius = kEnd, .divisions_across = 8, .divisions_along = 40});
  const std::vector<std::int32_t> origin_ = NodesWhere(mesh_, [](const Vec3& X) { return X.z() < 1e-9; });
  const std::vector<std::int32_t> insertion_ = NodesWhere(mesh_, [](const Vec3& X) { return X.z() > kLength - 1e-9; });
  Problems problems_;
};

TEST_F(FittedToASpindle, StopRequestsAreHeeded) {
  const auto fit = FitMuscleSolid(mesh_, origin_, insertion_, {}, problems_);
  ASSERT_TRUE(fit) << problems_.ToString();
  std::stop_source source;
  source.request_stop();
  EXPECT_THROW(FitMuscleSolid(mesh_, origin_, insertion_, {}, problems_, source.get_token()), Stopped);
  ThreadTeam team(1, source.get_token());
  EXPECT_THROW(BsplineFibres(mesh_, BsplineLocator(fit->solid), team, problems_), Stopped);
  EXPECT_TRUE(problems_.empty());
}

// Curves of constant (u, v) keep their fraction of the radius: the fibre at radius r is ez + r R'(z) / R(z) er.
TEST_F(FittedToASpindle, FibresKeepTheirShareOfTheRadius) {
  const auto fit = FitMuscleSolid(mesh_, origin_, insertion_, {}, problems_);
  ASSERT_TRUE(fit) << problems_.ToString();
  EXPECT_LE(fit->rms, 0.01 * kBelly);
  ThreadTeam team(2);
  const BsplineFibreField field = BsplineFibres(mesh_, BsplineLocator(fit->solid), team, problems_);
  ASSERT_THAT(field.fibres, SizeIs(mesh_.tetrahedra.size())) << problems_.ToString();
  EXPECT_EQ(field.folded, 0u);
  EXPECT_LE(field.outside, mesh_.tetrahedra.size() / 100);

  FibreField expected;
  for (std::size_t e = 0; e < mesh_.tetrahedra.size(); ++e) {
    const Vec3 X = Centroid(mesh_, e);
    const double phase = std::numbers::pi * X.z() / kLength;
    const double radius = kEnd + (kBelly - kEnd) * std::pow(std::sin(phase), 2);
    const double slope = (kBelly - kEnd) * std::sin(2 * phase) * std::numbers::pi / kLength;
    expected.push_back(Vec3(X.x() * slope / radius, X.y() * slope / radius, 1).normalized());
  }
  const Angles angles = Between(mesh_, field.fibres, expected);
  const Angles untreated = Between(mesh_, ConstantFibres(mesh_, Vec3::UnitZ()), expected);
  RecordProperty("mean_degrees", ::testing::PrintToString(angles.mean / kDegree));
  EXPECT_LE(angles.mean, 0.7 * kDegree);
  EXPECT_LE(angles.p95, 2 * kDegree);
  EXPECT_GT(untreated.mean, 4 * kDegree) << "or the comparison says nothing";
}

TEST_F(FittedToASpindle, RunFromTheOriginToTheInsertion) {
  const auto forth = FitMuscleSolid(mesh_, origin_, insertion_, {}, problems_);
  const auto back = FitMuscleSolid(mesh_, insertion_, origin_, {}, problems_);
  ASSERT_TRUE(forth && back) << problems_.ToString();
  EXPECT_GT(forth->solid.At({0.5, 0.5, 0.5}).gradients(2, 2), 0.9 * kLength);
  EXPECT_LT(back->solid.At({0.5, 0.5, 0.5}).gradients(2, 2), -0.9 * kLength);
  EXPECT_NEAR(forth->solid.At({0.5, 0.5, 0}).position.z(), 0, 1e-3);
  EXPECT_NEAR(forth->solid.At({0.5, 0.5, 1}).position.z(), kLength, 1e-3);
}

TEST_F(FittedToASpindle, MoreControlPointsFitBetterAndSmoothingWorse) {
  const auto rms = [&](const std::array<int, 3>& controls, double smoothing) {
    return FitMuscleSolid(mesh_, origin_, insertion_,
                          {.degrees = {3, 3, 3}, .controls = controls, .smoothing = smoothing}, problems_)
        ->rms;
  };
  EXPECT_LT(rms({5, 5, 16}, 1e-3), 0.7 * rms({4, 4, 6}, 1e-3));
  EXPECT_LT(rms({5, 5, 16}, 1e-3), 0.7 * rms({5, 5, 16}, 1));
}

TEST_F(FittedToASpindle, ThickAttachmentsHaveTheFibresOfTheirFaces) {
  const auto lower = NodesWhere(mesh_, [](const Vec3& X) { return X.z() < 0.031; });
  const auto fit = FitMuscleSolid(mesh_, lower, insertion_, {}, problems_);
  ASSERT_TRUE(fit) << problems_.ToString();
  EXPECT_NEAR(fit->solid.At({0.5, 0.5, 0}).position.z(), 0.03, 0.003);
  ThreadTeam team(2);
  const BsplineFibreField field = BsplineFibres(mesh_, BsplineLocator(fit->solid), team, problems_);
  ASSERT_THAT(field.fibres, SizeIs(mesh_.tetrahedra.size())) << problems_.ToString();
  EXPECT_GT(field.outside, 100u);
  EXPECT_NEAR(field.farthest, 0.03, 0.003);
  for (const Vec3& fibre : field.fibres) EXPECT_GT(fibre.z(), 0.8);
}

TEST_F(FittedToASpindle, NothingWithoutTwoEnds) {
  EXPECT_FALSE(FitMuscleSolid(mesh_, {}, insertion_, {}, problems_));
  EXPECT_THAT(problems_.ToString(), HasSubstr("origin contains no node"));
}

TEST(FitMuscleSolid, ThreeLayersOfTetrahedraAreEnough) {
  const TetMesh block = MakeBox(Vec3::Zero(), Vec3(1, 1, 2), {6, 6, 3});
  Problems problems;
  const auto fit = FitMuscleSolid(block, NodesWhere(block, [](const Vec3& X) { return X.z() < 1e-9; }),
                                  NodesWhere(block, [](const Vec3& X) { return X.z() > 2 - 1e-9; }), {}, problems);
  ASSERT_TRUE(fit) << problems.ToString();
  EXPECT_LE(fit->max, 0.1);
  EXPECT_GT(fit->solid.At({0.5, 0.5, 0.5}).gradients.col(2).normalized().z(), 0.99);
}

// Two slices of three tetrahedra each do not determine the middle line.
TEST(FitMuscleSolid, OneLayerOfTetrahedraIsTooShort) {
  const TetMesh cube = MakeBox(Vec3::Zero(), Vec3::Ones(), {1, 1, 1});
  Problems problems;
  EXPECT_FALSE(FitMuscleSolid(cube, NodesWhere(cube, [](const Vec3& X) { return X.z() < 0.5; }),
                              NodesWhere(cube, [](const Vec3& X) { return X.z() > 0.5; }), {}, problems));
  EXPECT_THAT(problems.ToString(), HasSubstr("is not close to the mesh"));
}

TEST(FitMuscleSolid, OneTetrahedronIsTooShort) {
  TetMesh one;
  one.nodes = {Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
  one.tetrahedra = {{0, 1, 2, 3}};
  Problems problems;
  EXPECT_FALSE(FitMuscleSolid(one, std::vector<std::int32_t>{0, 1, 2}, std::vector<std::int32_t>{3}, {}, problems));
  EXPECT_THAT(problems.ToString(), HasSubstr("no B-spline solid could be fitted"));
}

// --- Real anatomy ----------------------------------------------------------------------------------------------------

struct RealMuscle {
  const char* name;
  // Earlier measurements plus a fifth [degree]: B-spline against published, harmonic against published, one against the
  // other; means, then 95th percentiles.
  std::array<double, 3> mean, p95;
};

void PrintTo(const RealMuscle& muscle, std::ostream* out) { *out << muscle.name; }

class FittedToRealMuscle : public ::testing::TestWithParam<RealMuscle> {};

// Against the fibres published with the mesh for the same two attachments.
TEST_P(FittedToRealMuscle, FibresAgreeWithThePublished) {
  const std::filesystem::path data = testing::DataFolder();
  const std::string base = (data / "vh_muscle_tets" / GetParam().name).string();
  if (!std::filesystem::exists(base + ".msh")) GTEST_SKIP() << "no anatomy in " << data << "; set FASCICLE_DATA";
  const std::string bytes = testing::ReadFile(base + ".msh");
  Problems problems;
  auto mesh = ReadMesh({.name = "muscle.msh", .bytes = bytes, .element_bytes = {}}, problems);
  ASSERT_TRUE(mesh) << problems.ToString();
  for (Vec3& X : mesh->nodes) X *= 1e-3;
  const auto surface = BoundaryTriangles(*mesh);
  const Region first = SelectRegion(*mesh, surface, "attach1", TagSelector{1});
  const Region second = SelectRegion(*mesh, surface, "attach2", TagSelector{2});
  const FibreField harmonic = HarmonicFibres(*mesh, first.nodes, second.nodes, problems);
  const FibreField published = ReadFibres(*mesh, testing::ReadFile(base + ".fibres.txt"), problems);
  const auto fit = FitMuscleSolid(*mesh, first.nodes, second.nodes, {}, problems);
  ASSERT_TRUE(fit) << problems.ToString();
  ThreadTeam team(2);
  const BsplineFibreField field = BsplineFibres(*mesh, BsplineLocator(fit->solid), team, problems);
  ASSERT_TRUE(problems.empty()) << problems.ToString();

  EXPECT_LE(fit->rms, 2e-3);
  EXPECT_LE(fit->max, 9e-3);
  EXPECT_LE(field.outside, mesh->tetrahedra.size() / 15);
  EXPECT_LE(field.folded, mesh->tetrahedra.size() / 1000);
  const std::array<Angles, 3> angles = {Between(*mesh, field.fibres, published), Between(*mesh, harmonic, published),
                                        Between(*mesh, field.fibres, harmonic)};
  std::printf("%s: fit rms %.2f mm, max %.2f mm; %zu of %zu centroids outside, the farthest by %.1f mm, %zu folded\n",
              GetParam().name, 1e3 * fit->rms, 1e3 * fit->max, field.outside, mesh->tetrahedra.size(),
              1e3 * field.farthest, field.folded);
  constexpr std::array kPairs = {"B-spline and published", "harmonic and published", "B-spline and harmonic"};
  for (std::size_t pair = 0; pair < angles.size(); ++pair) {
    std::printf("  %-22s mean %5.2f degrees, 95th percentile %5.2f\n", kPairs[pair], angles[pair].mean / kDegree,
                angles[pair].p95 / kDegree);
    EXPECT_LE(angles[pair].mean, 1.2 * GetParam().mean[pair] * kDegree) << kPairs[pair];
    EXPECT_LE(angles[pair].p95, 1.2 * GetParam().p95[pair] * kDegree) << kPairs[pair];
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, FittedToRealMuscle,
    ::testing::Values(RealMuscle{"VHM_Left_Muscle_BicepsFemorisLongus", {2.7, 3.4, 2.7}, {6.0, 6.6, 5.4}},
                      RealMuscle{"VHM_Left_Muscle_TibialisAnterior", {2.7, 3.8, 3.0}, {7.2, 8.1, 6.6}}),
    [](const auto& muscle) {
      const std::string name = muscle.param.name;
      return name.substr(name.rfind('_') + 1);
    });

}  // namespace
}  // namespace fascicle
