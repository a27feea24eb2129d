#ifndef FASCICLE_PROTO_RULES_FIELD_RULES_H_
#define FASCICLE_PROTO_RULES_FIELD_RULES_H_

#include <optional>
#include <string>
#include <vector>

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>

#include "core/base/problems.h"

namespace fascicle {

// The rule in the last line of a number's comment in the .proto files:
//   Unit U; [N values;] range R; default D | required | optional.
struct FieldRule {
  std::string unit;
  int values = 0;  // length of a list; 0: any
  double min = 0, max = 0;
  bool min_open = false, max_open = false;
  std::vector<double> defaults;  // one value, or `values` of them; empty: none
  bool required = false;
  std::string range_text;    // as written
  std::string default_text;  // as written; empty: none
};

// The rule of a field; nothing if its comment has none. Read once from the embedded descriptors.
std::optional<FieldRule> RuleOf(const google::protobuf::FieldDescriptor& field);

// The comment of a message, field, oneof, enum or enum value, without the rule line.
std::string CommentOf(const google::protobuf::Descriptor& message);
std::string CommentOf(const google::protobuf::FieldDescriptor& field);
std::string CommentOf(const google::protobuf::EnumDescriptor& type);
std::string CommentOf(const google::protobuf::EnumValueDescriptor& value);

// Checks every number in `message`, at any depth, against its rule: present if required, the right number of values,
// finite, in range. A number without a rule must be finite. Enumerations must have a known value, and every oneof a
// member. Adds each problem with its path ("bodies[0].density", "bodies[0].material.law").
void CheckRules(const google::protobuf::Message& message, Problems& problems);

// Sets every absent number that has a default, at any depth, in messages that are present.
void FillDefaults(google::protobuf::Message& message);

}  // namespace fascicle

#endif  // FASCICLE_PROTO_RULES_FIELD_RULES_H_
