#include "core/muscle/pennation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "core/geometry/shapes.h"

namespace fascicle {
namespace {

using ::testing::HasSubstr;

class PennationTest : public ::testing::Test {
 protected:
  const TetMesh mesh_ = MakeBox(Vec3::Zero(), Vec3(1, 1, 2), {4, 3, 3});
  Problems problems_;
};

TEST_F(PennationTest, TurnsFibresTowardsTheNormal) {
  for (const double length : {1e-100, 1.0, 1e100}) {
    FibreField fibres = ConstantFibres(mesh_, Vec3::UnitZ());
    // The component of the normal along the fibres has no effect.
    Pennate(mesh_, {.angle = 0.3, .normal = length * Vec3(0, 2, 5), .mirror_point = {}}, fibres, problems_);
    EXPECT_TRUE(problems_.empty()) << problems_.ToString();
    for (const Vec3& fibre : fibres) EXPECT_LE((fibre - Vec3(0, std::sin(0.3), std::cos(0.3))).norm(), 1e-15);
  }
}

// About the axis a x n, as Eigen's rotation does it, for any fibre.
TEST_F(PennationTest, IsARotationAboutTheAxisAcrossFibreAndNormal) {
  FibreField fibres;
  for (std::size_t e = 0; e < mesh_.tetrahedra.size(); ++e)
    fibres.push_back((Centroid(mesh_, e) + Vec3(0.1, 0, 0)).normalized());
  const FibreField before = fibres;
  const Vec3 normal(-1, 0.3, 0.2);
  Pennate(mesh_, {.angle = 1.1, .normal = normal, .mirror_point = {}}, fibres, problems_);
  for (std::size_t e = 0; e < fibres.size(); ++e) {
    const Vec3 expected = Eigen::AngleAxisd(1.1, before[e].cross(normal).normalized()) * before[e];
    EXPECT_LE((fibres[e] - expected).norm(), 1e-14);
    EXPECT_NEAR(fibres[e].dot(before[e]), std::cos(1.1), 1e-14);
    EXPECT_NEAR(fibres[e].norm(), 1, 1e-15);
  }
}

TEST_F(PennationTest, MirrorsABipennateMuscle) {
  FibreField fibres = ConstantFibres(mesh_, Vec3::UnitZ());
  Pennate(mesh_, {.angle = 0.4, .normal = Vec3::UnitX(), .mirror_point = Vec3(0.5, 7, -3)}, fibres, problems_);
  int beyond = 0;
  for (std::size_t e = 0; e < fibres.size(); ++e) {
    const double side = Centroid(mesh_, e).x() > 0.5 ? 1 : -1;
    EXPECT_LE((fibres[e] - Vec3(side * std::sin(0.4), 0, std::cos(0.4))).norm(), 1e-15);
    beyond += side > 0 ? 1 : 0;
  }
  EXPECT_EQ(2 * static_cast<std::size_t>(beyond), fibres.size());
}

TEST_F(PennationTest, KeepsFibresInTheMirrorPlane) {
  FibreField fibres = ConstantFibres(mesh_, Vec3::UnitZ());
  const double x = Centroid(mesh_, 5).x();
  Pennate(mesh_, {.angle = 0.4, .normal = Vec3::UnitX(), .mirror_point = Vec3(x, 0, 0)}, fibres, problems_);
  EXPECT_EQ(fibres[5], Vec3::UnitZ());
}

TEST_F(PennationTest, CountsFibresAlongTheNormal) {
  FibreField fibres = ConstantFibres(mesh_, Vec3::UnitZ());
  fibres[3] = fibres[8] = -Vec3::UnitX();
  Pennate(mesh_, {.angle = 0.4, .normal = Vec3::UnitX(), .mirror_point = {}}, fibres, problems_);
  ASSERT_EQ(problems_.count(), 1u);
  EXPECT_EQ(problems_.kept()[0].path, "normal");
  EXPECT_THAT(problems_.kept()[0].message, HasSubstr("of 2 elements"));
}

}  // namespace
}  // namespace fascicle
