#include <charconv>
#include <cmath>
#include <string>
#include <vector>

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>

#include "proto/rules/field_rules.h"

namespace fascicle {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;

bool IsNumber(const FieldDescriptor& field) {
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_DOUBLE:
    case FieldDescriptor::CPPTYPE_INT32:
    case FieldDescriptor::CPPTYPE_INT64:
      return true;
    default:
      return false;
  }
}

// One number of a field; `index` selects an entry of a repeated field and is ignored otherwise.
double Get(const Message& message, const FieldDescriptor* field, int index) {
  const Reflection& r = *message.GetReflection();
  const bool list = field->is_repeated();
  switch (field->cpp_type()) {
    case FieldDescriptor::CPPTYPE_INT32:
      return list ? r.GetRepeatedInt32(message, field, index) : r.GetInt32(message, field);
    case FieldDescriptor::CPPTYPE_INT64:
      return static_cast<double>(list ? r.GetRepeatedInt64(message, field, index) : r.GetInt64(message, field));
    default:
      return list ? r.GetRepeatedDouble(message, field, index) : r.GetDouble(message, field);
  }
}

// Sets a singular field, or appends to a list.
void Put(Message& message, const FieldDescriptor* field, double value) {
  const Reflection& r = *message.GetReflection();
  const bool list = field->is_repeated();
  switch (field->cpp_type()) {
    case FieldDescriptor::CPPTYPE_INT32:
      if (list) {
        r.AddInt32(&message, field, static_cast<std::int32_t>(value));
      } else {
        r.SetInt32(&message, field, static_cast<std::int32_t>(value));
      }
      break;
    case FieldDescriptor::CPPTYPE_INT64:
      if (list) {
        r.AddInt64(&message, field, static_cast<std::int64_t>(value));
      } else {
        r.SetInt64(&message, field, static_cast<std::int64_t>(value));
      }
      break;
    default:
      if (list) {
        r.AddDouble(&message, field, value);
      } else {
        r.SetDouble(&message, field, value);
      }
  }
}

// The shortest text that reads back as the same number.
std::string Text(double value) {
  char buffer[32];
  return {buffer, std::to_chars(buffer, buffer + sizeof(buffer), value).ptr};
}

// "kg/m^3, range (0, 30000], default 1060"
std::string Hint(const FieldRule& rule) {
  std::string hint = rule.values > 0 ? std::to_string(rule.values) + " values; " : "";
  hint += "unit " + rule.unit + ", range " + rule.range_text;
  if (!rule.default_text.empty()) hint += ", default " + rule.default_text;
  if (rule.required) hint += ", required";
  return hint;
}

bool InRange(const FieldRule& rule, double value) {
  return (rule.min_open ? value > rule.min : value >= rule.min) &&
         (rule.max_open ? value < rule.max : value <= rule.max);
}

bool IsGood(const FieldRule* rule, double value) {
  return std::isfinite(value) && (rule == nullptr || InRange(*rule, value));
}

void AddBadNumber(const FieldRule* rule, double value, std::string path, Problems& problems) {
  problems.Add(std::move(path),
               "is " + Text(value) +
                   (std::isfinite(value) ? ", outside the range " + rule->range_text : "; every number must be finite"),
               rule == nullptr ? std::string() : Hint(*rule));
}

void CheckList(const Message& message, const FieldDescriptor* field, const FieldRule* rule, const std::string& path,
               Problems& problems) {
  const int size = message.GetReflection()->FieldSize(message, field);
  if (rule != nullptr && size == 0) {
    if (rule->required) problems.Add(path, "is missing", Hint(*rule));
    return;
  }
  if (rule != nullptr && rule->values > 0 && size != rule->values) {
    problems.Add(path, "has " + std::to_string(size) + " values instead of " + std::to_string(rule->values),
                 Hint(*rule));
  }
  for (int i = 0; i < size; ++i) {
    const double value = Get(message, field, i);
    if (!IsGood(rule, value)) AddBadNumber(rule, value, IndexPath(path, static_cast<std::size_t>(i)), problems);
  }
}

void CheckScalar(const Message& message, const FieldDescriptor* field, const FieldRule* rule, const std::string& path,
                 Problems& problems) {
  const bool absent = !message.GetReflection()->HasField(message, field);  // without presence: whether it is 0
  if (absent && rule != nullptr && rule->required && (field->has_presence() || !InRange(*rule, 0))) {
    problems.Add(path, field->has_presence() ? "is missing" : "is missing or 0", Hint(*rule));
  } else if (const double value = Get(message, field, 0); !absent && !IsGood(rule, value)) {
    AddBadNumber(rule, value, path, problems);
  }
}

// Enumerations are open on the wire: values unknown to this program may arrive.
void CheckEnum(const Message& message, const FieldDescriptor* field, const std::string& path, Problems& problems) {
  const Reflection& r = *message.GetReflection();
  const int size = field->is_repeated() ? r.FieldSize(message, field) : 1;
  for (int i = 0; i < size; ++i) {
    const int value = field->is_repeated() ? r.GetRepeatedEnumValue(message, field, i) : r.GetEnumValue(message, field);
    if (field->enum_type()->FindValueByNumber(value) != nullptr) continue;
    problems.Add(field->is_repeated() ? IndexPath(path, static_cast<std::size_t>(i)) : path,
                 "is " + std::to_string(value) + ", which is not a value of " + field->enum_type()->name());
  }
}

// Every oneof requires exactly one member: none is a problem; two cannot occur.
void CheckOneofs(const Message& message, const std::string& prefix, Problems& problems) {
  const google::protobuf::Descriptor* type = message.GetDescriptor();
  for (int i = 0; i < type->real_oneof_decl_count(); ++i) {
    const google::protobuf::OneofDescriptor* oneof = type->oneof_decl(i);
    if (message.GetReflection()->HasOneof(message, oneof)) continue;
    std::string choices;
    for (int k = 0; k < oneof->field_count(); ++k) choices += (k > 0 ? ", " : "") + oneof->field(k)->name();
    problems.Add(JoinPath(prefix, oneof->name()), "is missing", "give one of: " + choices);
  }
}

void Check(const Message& message, const std::string& prefix, Problems& problems) {
  CheckOneofs(message, prefix, problems);
  const Reflection& r = *message.GetReflection();
  for (int i = 0; i < message.GetDescriptor()->field_count(); ++i) {
    const FieldDescriptor* field = message.GetDescriptor()->field(i);
    // A member of a oneof that was not chosen is not missing.
    if (field->real_containing_oneof() != nullptr && !r.HasField(message, field)) continue;
    const std::string path = JoinPath(prefix, field->name());
    if (field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
      if (!field->is_repeated()) {
        if (r.HasField(message, field)) Check(r.GetMessage(message, field), path, problems);
        continue;
      }
      for (int k = 0; k < r.FieldSize(message, field); ++k) {
        Check(r.GetRepeatedMessage(message, field, k), IndexPath(path, static_cast<std::size_t>(k)), problems);
      }
    } else if (field->cpp_type() == FieldDescriptor::CPPTYPE_ENUM) {
      CheckEnum(message, field, path, problems);
    } else if (IsNumber(*field)) {
      const auto rule = RuleOf(*field);
      const FieldRule* known = rule ? &*rule : nullptr;
      if (field->is_repeated()) {
        CheckList(message, field, known, path, problems);
      } else {
        CheckScalar(message, field, known, path, problems);
      }
    }
  }
}

bool IsAbsent(const Message& message, const FieldDescriptor* field) {
  const Reflection& r = *message.GetReflection();
  if (field->is_repeated()) return r.FieldSize(message, field) == 0;
  return !r.HasField(message, field);  // without presence: whether it is 0
}

}  // namespace

void CheckRules(const Message& message, Problems& problems) { Check(message, "", problems); }

void FillDefaults(Message& message) {
  const Reflection& r = *message.GetReflection();
  for (int i = 0; i < message.GetDescriptor()->field_count(); ++i) {
    const FieldDescriptor* field = message.GetDescriptor()->field(i);
    if (field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
      if (!field->is_repeated()) {
        if (r.HasField(message, field)) FillDefaults(*r.MutableMessage(&message, field));
        continue;
      }
      for (int k = 0; k < r.FieldSize(message, field); ++k) FillDefaults(*r.MutableRepeatedMessage(&message, field, k));
    } else if (IsNumber(*field) && field->real_containing_oneof() == nullptr && IsAbsent(message, field)) {
      const auto rule = RuleOf(*field);
      if (!rule) continue;
      for (const double value : rule->defaults) Put(message, field, value);
    }
  }
}

}  // namespace fascicle
