// The table of output fields, and their values at a point.
#include <gtest/gtest.h>

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

TEST(OutputFieldsTest, DirectionsAreOfUnitLengthOrZero) {
  std::vector<double> directions = {3, 0, 4, 0, 0, 0};
  NormalizeDirections(directions);
  EXPECT_EQ(directions, (std::vector<double>{0.6, 0, 0.8, 0, 0, 0}));
}

TEST(OutputFieldsTest, PlacesAreThoseOfTheMethod) {
  const OutputFieldInfo& velocity = InfoOf(OutputField::kVelocity);
  const OutputFieldInfo& stress = InfoOf(OutputField::kCauchyStress);
  const std::array methods = {Method::kTet, Method::kVoxel, Method::kEulerian};
  const std::array elements = {FieldLocation::kTetrahedron, FieldLocation::kBrick, FieldLocation::kNode};
  const std::array<std::size_t, 3> nodes = {8, 12, 8}, places = {6, 2, 8};
  const std::vector<Scene> scenes = testing::FullScenes();
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(LocationOf(velocity, methods[k]), FieldLocation::kNode);
    EXPECT_EQ(LocationOf(stress, methods[k]), elements[k]);
    EXPECT_EQ(PlacesOf(velocity, scenes[k].bodies[0].shape), nodes[k]);
    EXPECT_EQ(PlacesOf(stress, scenes[k].bodies[0].shape), places[k]);
  }
}

}  // namespace
}  // namespace fascicle
