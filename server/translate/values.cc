#include "server/translate/values.h"

#include <charconv>

#include "proto/rules/field_rules.h"

namespace fascicle::server {

bool ObeysRules(const google::protobuf::Message& message) {
  Problems problems;
  CheckRules(message, problems);
  return problems.empty();
}

Vec3 ToVec3(const google::protobuf::RepeatedField<double>& values) {
  return values.size() == 3 ? Vec3(values[0], values[1], values[2]) : Vec3::Zero();
}

Vec3 ToDirection(const google::protobuf::RepeatedField<double>& values, const std::string& path, Problems& problems) {
  const Vec3 vector = ToVec3(values);
  // Scaled first, so that very long vectors do not overflow.
  const double largest = vector.cwiseAbs().maxCoeff();
  if (values.size() == 3 && !(largest > 1e-150)) {
    problems.Add(path, "is the zero vector", "a direction of any non-zero length, such as [0, 0, 1]");
  }
  return largest > 1e-150 ? Vec3((vector / largest).normalized()) : Vec3(Vec3::UnitZ());
}

double MetresIn(v1::LengthUnit unit) {
  switch (unit) {
    case v1::LENGTH_UNIT_CM:
      return 1e-2;
    case v1::LENGTH_UNIT_MM:
      return 1e-3;
    default:
      return 1;
  }
}

std::string Text(double value) {
  char buffer[32];
  return {buffer, std::to_chars(buffer, buffer + sizeof(buffer), value).ptr};
}

}  // namespace fascicle::server
