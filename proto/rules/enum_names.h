#ifndef FASCICLE_PROTO_RULES_ENUM_NAMES_H_
#define FASCICLE_PROTO_RULES_ENUM_NAMES_H_

#include <string>

#include <google/protobuf/descriptor.h>

namespace fascicle {

// The name of a value as scene files write it: LENGTH_UNIT_MM of LengthUnit is `mm`.
std::string NameOf(const google::protobuf::EnumValueDescriptor& value);

}  // namespace fascicle

#endif  // FASCICLE_PROTO_RULES_ENUM_NAMES_H_
