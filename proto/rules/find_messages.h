#ifndef FASCICLE_PROTO_RULES_FIND_MESSAGES_H_
#define FASCICLE_PROTO_RULES_FIND_MESSAGES_H_

#include <string>
#include <type_traits>
#include <vector>

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>

#include "core/base/problems.h"

namespace fascicle {
namespace internal {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

inline const Message& PartOf(const Message& message, const FieldDescriptor* field) {
  return message.GetReflection()->GetMessage(message, field);
}
inline Message& PartOf(Message& message, const FieldDescriptor* field) {
  return *message.GetReflection()->MutableMessage(&message, field);
}
inline const Message& PartOf(const Message& message, const FieldDescriptor* field, int index) {
  return message.GetReflection()->GetRepeatedMessage(message, field, index);
}
inline Message& PartOf(Message& message, const FieldDescriptor* field, int index) {
  return *message.GetReflection()->MutableRepeatedMessage(&message, field, index);
}

}  // namespace internal

// Calls visit(found, path) for every message of the type `Wanted` in `message`, to any depth, in the order of field
// numbers: of a scene, for every v1::FileRef with its path, such as `bodies[0].mesh.file`. `message`, and with it what
// is found, may be const. Does not look into what it has found.
template <class Wanted, class Root, class Visit>
void ForEachMessage(Root& message, const std::string& path, const Visit& visit) {
  using Found = std::conditional_t<std::is_const_v<Root>, const Wanted, Wanted>;
  using Part = std::conditional_t<std::is_const_v<Root>, const google::protobuf::Message, google::protobuf::Message>;
  if (auto* found = dynamic_cast<Found*>(&message)) {
    visit(*found, path);
    return;
  }
  std::vector<const google::protobuf::FieldDescriptor*> fields;
  message.GetReflection()->ListFields(message, &fields);
  for (const auto* field : fields) {
    if (field->cpp_type() != google::protobuf::FieldDescriptor::CPPTYPE_MESSAGE) continue;
    const std::string field_path = JoinPath(path, field->name());
    if (!field->is_repeated()) {
      ForEachMessage<Wanted, Part>(internal::PartOf(message, field), field_path, visit);
      continue;
    }
    for (int i = 0; i < message.GetReflection()->FieldSize(message, field); ++i) {
      ForEachMessage<Wanted, Part>(internal::PartOf(message, field, i),
                                   IndexPath(field_path, static_cast<std::size_t>(i)), visit);
    }
  }
}

}  // namespace fascicle

#endif  // FASCICLE_PROTO_RULES_FIND_MESSAGES_H_
