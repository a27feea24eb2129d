#include <map>
#include <stdexcept>
#include <string>
#include <string_view>

#include <google/protobuf/descriptor.h>
#include <google/protobuf/descriptor.pb.h>

#include "proto/rules/field_rules.h"
#include "proto/rules/parse_rule.h"

namespace fascicle {

std::string_view EmbeddedDescriptors();

namespace {

using google::protobuf::Descriptor;
using google::protobuf::EnumDescriptor;
using google::protobuf::EnumValueDescriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::FileDescriptor;

// Comments and rules by full name. The descriptors that protoc compiles into a program lack comments, so a copy is
// embedded.
class CommentTable {
 public:
  CommentTable() {
    google::protobuf::FileDescriptorSet set;
    const std::string_view bytes = EmbeddedDescriptors();
    if (!set.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
      throw std::logic_error("the built-in descriptors can't be read");
    }
    google::protobuf::DescriptorPool pool;
    for (const auto& file : set.file()) {
      const FileDescriptor* built = pool.BuildFile(file);
      if (built == nullptr) throw std::logic_error("the built-in descriptor of " + file.name() + " is broken");
      if (built->package().starts_with("fascicle.")) AddFile(*built);
    }
  }

  std::string Text(const std::string& full_name) const {
    const auto found = texts_.find(full_name);
    return found == texts_.end() ? std::string() : found->second;
  }

  std::optional<FieldRule> Rule(const std::string& full_name) const {
    const auto found = rules_.find(full_name);
    if (found == rules_.end()) return std::nullopt;
    return found->second;
  }

 private:
  void AddFile(const FileDescriptor& file) {
    for (int i = 0; i < file.message_type_count(); ++i) AddMessage(*file.message_type(i));
    for (int i = 0; i < file.enum_type_count(); ++i) AddEnum(*file.enum_type(i));
  }

  void AddMessage(const Descriptor& message) {
    AddText(message);
    for (int i = 0; i < message.field_count(); ++i) AddText(*message.field(i));
    for (int i = 0; i < message.enum_type_count(); ++i) AddEnum(*message.enum_type(i));
    for (int i = 0; i < message.nested_type_count(); ++i) AddMessage(*message.nested_type(i));
  }

  void AddEnum(const EnumDescriptor& type) {
    AddText(type);
    for (int i = 0; i < type.value_count(); ++i) AddText(*type.value(i));
  }

  template <class D>
  void AddText(const D& descriptor) {
    google::protobuf::SourceLocation location;
    if (!descriptor.GetSourceLocation(&location)) return;
    SplitComment split = Split(location.leading_comments);
    texts_[descriptor.full_name()] = std::move(split.text);
    if (split.rule.empty()) return;
    const auto rule = ParseRule(split.rule);
    if (!rule) throw std::logic_error("comment of " + descriptor.full_name() + ": not a rule: " + split.rule);
    rules_[descriptor.full_name()] = *rule;
  }

  std::map<std::string, std::string> texts_;
  std::map<std::string, FieldRule> rules_;
};

const CommentTable& Comments() {
  static const CommentTable table;
  return table;
}

}  // namespace

std::optional<FieldRule> RuleOf(const FieldDescriptor& field) { return Comments().Rule(field.full_name()); }

std::string CommentOf(const Descriptor& message) { return Comments().Text(message.full_name()); }
std::string CommentOf(const FieldDescriptor& field) { return Comments().Text(field.full_name()); }
std::string CommentOf(const EnumDescriptor& type) { return Comments().Text(type.full_name()); }
std::string CommentOf(const EnumValueDescriptor& value) { return Comments().Text(value.full_name()); }

}  // namespace fascicle
