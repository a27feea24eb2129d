#ifndef FASCICLE_SERVER_TRANSLATE_VALUES_H_
#define FASCICLE_SERVER_TRANSLATE_VALUES_H_

#include <string>

#include <google/protobuf/message.h>
#include <google/protobuf/repeated_field.h>

#include "core/base/problems.h"
#include "core/base/types.h"
#include "fascicle/v1/scene.pb.h"

namespace fascicle::server {

// Whether CheckRules has nothing to say of `message`. TranslateScene reports what it says once, for the whole scene;
// the parts ask again before they use values.
bool ObeysRules(const google::protobuf::Message& message);

// Three values; zero when there are not three.
Vec3 ToVec3(const google::protobuf::RepeatedField<double>& values);

// As ToVec3; a zero vector, or one so short that its length can't be told from zero, is a problem.
Vec3 ToDirection(const google::protobuf::RepeatedField<double>& values, const std::string& path, Problems& problems);

// Metres in a unit; 1 for LENGTH_UNIT_UNSPECIFIED.
double MetresIn(v1::LengthUnit unit);

// The shortest text that reads back as the same number.
std::string Text(double value);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_VALUES_H_
