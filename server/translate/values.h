#ifndef FASCICLE_SERVER_TRANSLATE_VALUES_H_
#define FASCICLE_SERVER_TRANSLATE_VALUES_H_

#include <string>

#include <google/protobuf/message.h>
#include <google/protobuf/repeated_field.h>

#include "core/base/problems.h"
#include "core/base/types.h"
#include "fascicle/v1/scene.pb.h"

namespace fascicle::server {

// Whether CheckRules has no problem with `message`. TranslateScene reports its problems once, for the whole scene;
// parts check again before they use values.
bool ObeysRules(const google::protobuf::Message& message);

// Three values; zero if there are not three.
Vec3 ToVec3(const google::protobuf::RepeatedField<double>& values);

// Like ToVec3; a zero vector, or one too short to be distinguished from zero, is a problem.
Vec3 ToDirection(const google::protobuf::RepeatedField<double>& values, const std::string& path, Problems& problems);

// Metres per unit; 1 for LENGTH_UNIT_UNSPECIFIED.
double MetresIn(v1::LengthUnit unit);

// The shortest text that reads back as the same number.
std::string Text(double value);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_VALUES_H_
