// The table of output fields, and their values at a point.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "core/base/von_mises.h"
#include "core/scene/output_fields.h"
#include "tests/support/full_scenes.h"

namespace fascicle {
namespace {

std::vector<double> ValuesAt(OutputField field, const MaterialPoint& at) {
  std::vector<double> values(InfoOf(field).components);
  PutField(field, at, values.data());
  return values;
}

MaterialPoint Point() {
  MaterialPoint at;
  at.v = Vec3(1, 2, 3);
  at.F << 1, 0.5, 0, 0, 2, 0, 0, 0, 3;
  at.J = 6;
  at.a0 = Vec3::UnitY();
  at.sigma << 1, 2, 3, 2, 5, 7, 3, 7, 9;
  return at;
}

TEST(OutputFieldsTest, EachIsFoundByItsName) {
  std::set<std::string> names;
  for (const OutputFieldInfo& info : OutputFields()) {
    EXPECT_TRUE(names.insert(info.name).second) << info.name;
    EXPECT_EQ(FindOutputField(info.name), &InfoOf(info.field));
  }
  EXPECT_EQ(FindOutputField("colour"), nullptr);
}

TEST(OutputFieldsTest, AreWhatTheirPointSays) {
  const MaterialPoint at = Point();
  EXPECT_EQ(ValuesAt(OutputField::kVelocity, at), (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(ValuesAt(OutputField::kCauchyStress, at), (std::vector<double>{1, 5, 9, 2, 7, 3}));  // xx yy zz xy yz xz
  EXPECT_EQ(ValuesAt(OutputField::kVonMisesStress, at), std::vector<double>{VonMises(at.sigma)});
  EXPECT_EQ(ValuesAt(OutputField::kPressure, at), std::vector<double>{5});
  EXPECT_EQ(ValuesAt(OutputField::kVolumeRatio, at), std::vector<double>{6});
  EXPECT_EQ(ValuesAt(OutputField::kFibreStretch, at), std::vector<double>{std::sqrt(4.25)});
  EXPECT_EQ(ValuesAt(OutputField::kFibreDirection, at), (std::vector<double>{0.5, 2, 0}));
}

// F = R diag(stretches) Q^T: stretches along the columns of Q at rest, along those of R in the deformed body.
MaterialPoint Stretched(const Vec3& stretches, const Mat3& R, const Mat3& Q) {
  MaterialPoint at;
  at.F = R * stretches.asDiagonal() * Q.transpose();
  at.J = at.F.determinant();
  return at;
}

Mat3 Rotation(double angle, const Vec3& axis) { return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix(); }

Mat3 TensorOf(const std::vector<double>& s) {
  return (Mat3() << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2]).finished();
}

// Also where principal values repeat, and close to that.
TEST(OutputFieldsTest, StrainsAreThoseOfTheirStretches) {
  const Mat3 R = Rotation(0.7, Vec3(1, 2, 3)), Q = Rotation(1.9, Vec3(-1, 0.5, 2));
  for (const Vec3& stretches : {Vec3(1.5, 1.1, 0.6), Vec3(1.3, 1.3, 0.7), Vec3(1.2, 1.2, 1.2), Vec3(1, 1, 1),
                                Vec3(1.1 + 1e-9, 1.1, 0.9), Vec3(2, 1, 1), Vec3(1 + 1e-7, 1, 1 - 1e-7)}) {
    const MaterialPoint at = Stretched(stretches, R, Q);
    const Vec3 squares = 0.5 * (stretches.array().square() - 1), logs = stretches.array().log();
    const Mat3 green = Q * squares.asDiagonal() * Q.transpose(), hencky = R * logs.asDiagonal() * R.transpose();
    EXPECT_LT((TensorOf(ValuesAt(OutputField::kGreenLagrangeStrain, at)) - green).norm(), 1e-14);
    EXPECT_LT((TensorOf(ValuesAt(OutputField::kLogarithmicStrain, at)) - hencky).norm(), 1e-14);
    const std::vector<double> principal = ValuesAt(OutputField::kPrincipalStrains, at);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(principal[static_cast<std::size_t>(k)], logs[k], 1e-14);
  }
}

// Simple shear by g: E_xy = g/2, E_yy = g^2/2, and the largest principal stretch g/2 + sqrt(1 + g^2/4).
TEST(OutputFieldsTest, StrainsOfSimpleShear) {
  constexpr double kShear = 0.8;
  MaterialPoint at;
  at.F(0, 1) = kShear;
  const std::vector<double> green = ValuesAt(OutputField::kGreenLagrangeStrain, at);
  EXPECT_NEAR(green[3], kShear / 2, 1e-15);
  EXPECT_NEAR(green[1], kShear * kShear / 2, 1e-15);
  const double largest = std::asinh(kShear / 2);
  const std::vector<double> principal = ValuesAt(OutputField::kPrincipalStrains, at);
  EXPECT_NEAR(principal[0], largest, 1e-14);
  EXPECT_NEAR(principal[1], 0, 1e-14);
  EXPECT_NEAR(principal[2], -largest, 1e-14);
}

TEST(OutputFieldsTest, PrincipalStressesHaveTheirDirections) {
  const Mat3 R = Rotation(0.7, Vec3(1, 2, 3));
  for (const Vec3& values : {Vec3(5e3, 2e3, -1e4), Vec3(3e3, 3e3, -1e3), Vec3(7e3, 7e3, 7e3)}) {
    MaterialPoint at;
    at.sigma = R * values.asDiagonal() * R.transpose();
    const std::vector<double> principal = ValuesAt(OutputField::kPrincipalStresses, at);
    const std::vector<double> directions = ValuesAt(OutputField::kPrincipalStressDirections, at);
    const Eigen::Map<const Mat3> v(directions.data());
    EXPECT_LT((v.transpose() * v - Mat3::Identity()).norm(), 1e-14);
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(principal[static_cast<std::size_t>(k)], values[k], 1e-10);
      EXPECT_LT((at.sigma * v.col(k) - values[k] * v.col(k)).norm(), 1e-10);
    }
  }
}

// A fibre's tension s adds s (a x a - I/3) to the stress, or s a x a; both are s along the fibre beyond that across it.
TEST(OutputFieldsTest, FibreStressIsThatBeyondThePressure) {
  MaterialPoint at = Point();
  const Vec3 a = (at.F * at.a0).normalized();
  at.passive_sigma = -4 * Mat3::Identity() + 2 * (a * a.transpose() - Mat3::Identity() / 3);
  at.sigma = at.passive_sigma + 5 * a * a.transpose();
  EXPECT_NEAR(ValuesAt(OutputField::kPassiveFibreStress, at)[0], 2, 1e-14);
  EXPECT_NEAR(ValuesAt(OutputField::kActiveFibreStress, at)[0], 5, 1e-14);
  EXPECT_NEAR(ValuesAt(OutputField::kFibreStress, at)[0], 7, 1e-14);
  at.a0.setZero();
  EXPECT_EQ(ValuesAt(OutputField::kFibreStress, at)[0], 0);
}

TEST(OutputFieldsTest, PennationIsTheAngleBetweenLines) {
  MaterialPoint at;
  at.a0 = Rotation(0.4, Vec3::UnitY()) * Vec3::UnitX();
  EXPECT_NEAR(ValuesAt(OutputField::kPennationAngle, at)[0], 0.4, 1e-15);
  at.line_of_action = -at.line_of_action;
  EXPECT_NEAR(ValuesAt(OutputField::kPennationAngle, at)[0], 0.4, 1e-15);
}

TEST(OutputFieldsTest, PrincipalValuesFollowFromTheMeanTensor) {
  const std::array<double, 6> mean = {1, 4, 2, 0, 0, 0};
  std::array<double, 9> values;
  PutFromMean(OutputField::kPrincipalStresses, mean.data(), values.data());
  EXPECT_EQ(std::vector<double>(values.begin(), values.begin() + 3), (std::vector<double>{4, 2, 1}));
  PutFromMean(OutputField::kPrincipalStressDirections, mean.data(), values.data());
  EXPECT_NEAR(std::abs(values[1]), 1, 1e-15);  // the first is along y
  PutFromMean(OutputField::kCauchyStress, mean.data(), values.data());
  EXPECT_EQ(values[1], 4);
}

TEST(OutputFieldsTest, AFieldThatTheSceneLacksIsRefusedWithItsPath) {
  struct Case {
    OutputField field;
    FieldMeans scene;
    const char* text;
  };
  for (const Case& c : {Case{OutputField::kReactionForce, {Method::kVoxel, false, false}, "does not provide"},
                        Case{OutputField::kInternalForce, {Method::kEulerian, true, false}, "does not provide"},
                        Case{OutputField::kActiveFibreStress, {Method::kTet, false, false}, "no body has fibres"},
                        Case{OutputField::kPennationAngle, {Method::kTet, true, false}, "no line of action"}}) {
    Problems problems;
    CheckOutputField(c.field, {}, c.scene, "output.fields[0]", problems);
    ASSERT_EQ(problems.count(), 1u) << InfoOf(c.field).name;
    EXPECT_EQ(problems.kept()[0].path, "output.fields[0]");
    EXPECT_NE(problems.kept()[0].message.find(c.text), std::string::npos) << problems.kept()[0].message;
  }
}

TEST(OutputFieldsTest, DirectionsAreOfUnitLengthOrZero) {
  std::vector<double> directions = {3, 0, 4, 0, 0, 0};
  NormalizeDirections(directions);
  EXPECT_EQ(directions, (std::vector<double>{0.6, 0, 0.8, 0, 0, 0}));
}

TEST(OutputFieldsTest, PlacesAreThoseOfTheMethod) {
  const OutputFieldInfo& velocity = InfoOf(OutputField::kVelocity);
  const OutputFieldInfo& stress = InfoOf(OutputField::kCauchyStress);
  const std::array elements = {FieldLocation::kTetrahedron, FieldLocation::kBrick, FieldLocation::kNode};
  const std::array<std::size_t, 3> nodes = {8, 12, 8}, places = {6, 2, 8};
  std::vector<Scene> scenes = testing::FullScenes();
  EXPECT_EQ(LocationOf(stress, scenes[0].bodies[0].shape), FieldLocation::kBrick) << "of hexahedra";
  EXPECT_EQ(PlacesOf(stress, scenes[0].bodies[0].shape), 1u);
  scenes[0].bodies[0].tet().mesh.hexahedra.clear();
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(LocationOf(velocity, scenes[k].bodies[0].shape), FieldLocation::kNode);
    EXPECT_EQ(LocationOf(stress, scenes[k].bodies[0].shape), elements[k]);
    EXPECT_EQ(PlacesOf(velocity, scenes[k].bodies[0].shape), nodes[k]);
    EXPECT_EQ(PlacesOf(stress, scenes[k].bodies[0].shape), places[k]);
  }
}

}  // namespace
}  // namespace fascicle
