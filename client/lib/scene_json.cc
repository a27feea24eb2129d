#include "client/lib/scene_json.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <set>
#include <vector>

#include "core/base/edit_distance.h"
#include "proto/rules/enum_names.h"

namespace fascicle::client {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::EnumDescriptor;
using google::protobuf::EnumValueDescriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::OneofDescriptor;
using google::protobuf::Reflection;
using nlohmann::json;

// Scenes are 8 levels deep; anything far beyond is a mistake or an attack.
constexpr int kMaxDepth = 64;

struct TooDeep {};

// Tracks the parser's position in the document, to know the path of every key and to detect duplicate keys.
class DuplicateKeys {
 public:
  explicit DuplicateKeys(Problems& problems) : problems_(problems) {}

  bool operator()(int depth, json::parse_event_t event, const json& parsed) {
    if (depth > kMaxDepth) throw TooDeep{};
    switch (event) {
      case json::parse_event_t::object_start:
      case json::parse_event_t::array_start:
        levels_.push_back({event == json::parse_event_t::array_start, Here(), 0, {}, {}});
        break;
      case json::parse_event_t::object_end:
      case json::parse_event_t::array_end:
        levels_.pop_back();
        EndOfValue();
        break;
      case json::parse_event_t::key: {
        Level& level = levels_.back();
        level.key = parsed.get<std::string>();
        if (!level.seen.insert(level.key).second) {
          problems_.Add(JoinPath(level.path, level.key), "is given twice", "keep one of them");
        }
        break;
      }
      case json::parse_event_t::value:
        EndOfValue();
        break;
    }
    return true;
  }

 private:
  struct Level {
    bool is_array;
    std::string path;
    std::size_t index;
    std::string key;
    std::set<std::string> seen;
  };

  std::string Here() const {
    if (levels_.empty()) return "";
    const Level& level = levels_.back();
    return level.is_array ? IndexPath(level.path, level.index) : JoinPath(level.path, level.key);
  }
  void EndOfValue() {
    if (!levels_.empty() && levels_.back().is_array) ++levels_.back().index;
  }

  Problems& problems_;
  std::vector<Level> levels_;
};

std::string PlaceOf(std::string_view text, std::size_t byte) {
  const std::string_view before = text.substr(0, std::min(byte, text.size()));
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const std::size_t start = before.rfind('\n');
  const std::size_t column = before.size() - (start == std::string_view::npos ? 0 : start + 1);
  return "line " + std::to_string(line) + ", column " + std::to_string(std::max<std::size_t>(column, 1));
}

// The library's message without its tag and position: "syntax error while parsing value - unexpected ..." ->
// "unexpected ...".
std::string SyntaxMessage(const std::string& what) {
  const std::size_t dash = what.find(" - ");
  if (dash != std::string::npos) return what.substr(dash + 3);
  const std::size_t bracket = what.find("] ");
  return bracket == std::string::npos ? what : what.substr(bracket + 2);
}

std::string Join(const std::vector<std::string>& names) {
  std::string joined;
  for (const std::string& name : names) joined += (joined.empty() ? "" : ", ") + name;
  return joined;
}

// "did you mean x?" if a known name is similar, otherwise the list of known names.
std::string NameHint(std::string_view wrong, const std::vector<std::string>& names) {
  const std::string shortened(wrong.substr(0, 64));
  std::size_t best = std::max<std::size_t>(2, shortened.size() / 3) + 1;
  const std::string* nearest = nullptr;
  for (const std::string& name : names) {
    const std::size_t distance = EditDistance(shortened, name);
    if (distance < best) {
      best = distance;
      nearest = &name;
    }
  }
  if (nearest != nullptr) return "did you mean " + *nearest + "?";
  return names.empty() ? "" : "known: " + Join(names);
}

std::string Quoted(std::string_view text) {
  constexpr std::size_t kMaxShown = 64;
  return "\"" + std::string(text.substr(0, kMaxShown)) + (text.size() > kMaxShown ? "..." : "") + "\"";
}

std::string KindOfValue(const json& value) {
  switch (value.type()) {
    case json::value_t::null:
      return "null";
    case json::value_t::boolean:
      return value.get<bool>() ? "true" : "false";
    case json::value_t::string:
      return "the text " + Quoted(value.get_ref<const std::string&>());
    case json::value_t::array:
      return "a list";
    case json::value_t::object:
      return "an object";
    default:
      return "the number " + value.dump();
  }
}

std::optional<int> ReadEnum(const std::string& text, const EnumDescriptor& type, const std::string& path,
                            Problems& problems) {
  std::vector<std::string> names;
  for (int i = 0; i < type.value_count(); ++i) {
    const EnumValueDescriptor& value = *type.value(i);
    if (value.number() == 0) continue;  // a missing value is expressed by omitting the field
    names.push_back(NameOf(value));
    if (text == names.back() || text == value.name()) return value.number();
  }
  problems.Add(path, "unknown value " + Quoted(text), NameHint(text, names));
  return std::nullopt;
}

class FieldReader {
 public:
  FieldReader(Message& message, const FieldDescriptor& field, Problems& problems)
      : message_(message), reflection_(*message.GetReflection()), field_(field), problems_(problems) {}

  void Read(const json& value, const std::string& path) {
    if (!field_.is_repeated()) return ReadOne(value, path);
    if (!value.is_array()) {
      problems_.Add(path, "expects a list, got " + KindOfValue(value), "write [ ... ]");
      return;
    }
    for (std::size_t i = 0; i < value.size(); ++i) ReadOne(value[i], IndexPath(path, i));
  }

 private:
  void ReadOne(const json& value, const std::string& path) {
    if (value.is_null()) {
      problems_.Add(path, "is null", "omit the field to use its default");
      return;
    }
    switch (field_.cpp_type()) {
      case FieldDescriptor::CPPTYPE_MESSAGE:
        return ReadMessage(value,
                           field_.is_repeated() ? *reflection_.AddMessage(&message_, &field_)
                                                : *reflection_.MutableMessage(&message_, &field_),
                           path, problems_);
      case FieldDescriptor::CPPTYPE_DOUBLE:
        if (!value.is_number()) return WrongType(value, "a number", path);
        return Set(value.get<double>(), &Reflection::SetDouble, &Reflection::AddDouble);
      case FieldDescriptor::CPPTYPE_INT32:
        if (const auto number = ReadInteger(value, path, std::numeric_limits<std::int32_t>::min(),
                                            std::numeric_limits<std::int32_t>::max())) {
          Set(static_cast<std::int32_t>(*number), &Reflection::SetInt32, &Reflection::AddInt32);
        }
        return;
      case FieldDescriptor::CPPTYPE_INT64:
        if (const auto number = ReadInteger(value, path, -kExact, kExact)) {
          Set(*number, &Reflection::SetInt64, &Reflection::AddInt64);
        }
        return;
      case FieldDescriptor::CPPTYPE_BOOL:
        if (!value.is_boolean()) return WrongType(value, "true or false", path);
        return Set(value.get<bool>(), &Reflection::SetBool, &Reflection::AddBool);
      case FieldDescriptor::CPPTYPE_STRING:
        if (!value.is_string()) return WrongType(value, "text in quotes", path);
        return field_.is_repeated() ? reflection_.AddString(&message_, &field_, value.get<std::string>())
                                    : reflection_.SetString(&message_, &field_, value.get<std::string>());
      case FieldDescriptor::CPPTYPE_ENUM:
        if (!value.is_string()) return WrongType(value, "a name in quotes", path);
        if (const auto number = ReadEnum(value.get<std::string>(), *field_.enum_type(), path, problems_)) {
          Set(*number, &Reflection::SetEnumValue, &Reflection::AddEnumValue);
        }
        return;
      default:
        problems_.Add(path, "cannot be set in a scene file");
    }
  }

  // Integers that a double represents exactly; JSON has no others.
  static constexpr std::int64_t kExact = std::int64_t{1} << 53;

  std::optional<std::int64_t> ReadInteger(const json& value, const std::string& path, std::int64_t lowest,
                                          std::int64_t highest) {
    if (!value.is_number()) {
      WrongType(value, "a whole number", path);
      return std::nullopt;
    }
    const double number = value.get<double>();
    if (number != std::floor(number)) {
      WrongType(value, "a whole number", path);
      return std::nullopt;
    }
    if (number < static_cast<double>(lowest) || number > static_cast<double>(highest)) {
      problems_.Add(path, value.dump() + " is out of range",
                    "whole numbers from " + std::to_string(lowest) + " to " + std::to_string(highest));
      return std::nullopt;
    }
    return static_cast<std::int64_t>(number);
  }

  void WrongType(const json& value, const std::string& expected, const std::string& path) {
    problems_.Add(path, "expects " + expected + ", got " + KindOfValue(value));
  }

  template <class T>
  void Set(T value, void (Reflection::*set)(Message*, const FieldDescriptor*, T) const,
           void (Reflection::*add)(Message*, const FieldDescriptor*, T) const) {
    (reflection_.*(field_.is_repeated() ? add : set))(&message_, &field_, value);
  }

  Message& message_;
  const Reflection& reflection_;
  const FieldDescriptor& field_;
  Problems& problems_;
};

using OrderedJson = nlohmann::ordered_json;

// One value of a field; `index` is negative for a field that is not repeated.
OrderedJson ValueOf(const Message& message, const FieldDescriptor& field, int index);

OrderedJson ObjectOf(const Message& message) {
  OrderedJson object = OrderedJson::object();
  const Reflection& reflection = *message.GetReflection();
  std::vector<const FieldDescriptor*> fields;
  reflection.ListFields(message, &fields);
  std::sort(fields.begin(), fields.end(), [](const auto* a, const auto* b) { return a->index() < b->index(); });
  for (const FieldDescriptor* field : fields) {
    if (!field->is_repeated()) {
      object[field->name()] = ValueOf(message, *field, -1);
      continue;
    }
    OrderedJson list = OrderedJson::array();
    for (int i = 0; i < reflection.FieldSize(message, field); ++i) list.push_back(ValueOf(message, *field, i));
    object[field->name()] = std::move(list);
  }
  return object;
}

OrderedJson ValueOf(const Message& message, const FieldDescriptor& field, int index) {
  const Reflection& reflection = *message.GetReflection();
  const bool one = index < 0;
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_MESSAGE:
      return ObjectOf(one ? reflection.GetMessage(message, &field)
                          : reflection.GetRepeatedMessage(message, &field, index));
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return one ? reflection.GetDouble(message, &field) : reflection.GetRepeatedDouble(message, &field, index);
    case FieldDescriptor::CPPTYPE_INT32:
      return one ? reflection.GetInt32(message, &field) : reflection.GetRepeatedInt32(message, &field, index);
    case FieldDescriptor::CPPTYPE_INT64:
      return one ? reflection.GetInt64(message, &field) : reflection.GetRepeatedInt64(message, &field, index);
    case FieldDescriptor::CPPTYPE_BOOL:
      return one ? reflection.GetBool(message, &field) : reflection.GetRepeatedBool(message, &field, index);
    case FieldDescriptor::CPPTYPE_ENUM:
      return NameOf(one ? *reflection.GetEnum(message, &field) : *reflection.GetRepeatedEnum(message, &field, index));
    default:
      return one ? reflection.GetString(message, &field) : reflection.GetRepeatedString(message, &field, index);
  }
}

// Prints indented, with values without parts on one line.
void Print(const OrderedJson& value, std::size_t indent, std::string& text) {
  const auto is_flat = [](const OrderedJson& item) { return !item.is_structured(); };
  if (!value.is_structured() || std::all_of(value.begin(), value.end(), is_flat)) {
    std::string line = value.dump(-1, ' ', false, OrderedJson::error_handler_t::replace);
    if (!value.is_structured() || value.is_array() || line.size() <= 80) {
      text += line;
      return;
    }
  }
  const std::string margin(indent + 2, ' ');
  text += value.is_array() ? "[" : "{";
  std::size_t count = 0;
  for (const auto& [key, item] : value.items()) {
    text += (count++ > 0 ? ",\n" : "\n") + margin;
    if (value.is_object()) text += OrderedJson(key).dump() + ": ";
    Print(item, indent + 2, text);
  }
  text += "\n" + std::string(indent, ' ') + (value.is_array() ? "]" : "}");
}

std::vector<std::string> FieldNames(const Descriptor& type) {
  std::vector<std::string> names;
  for (int i = 0; i < type.field_count(); ++i) names.push_back(type.field(i)->name());
  return names;
}

std::vector<std::string> MemberNames(const OneofDescriptor& oneof) {
  std::vector<std::string> names;
  for (int i = 0; i < oneof.field_count(); ++i) names.push_back(oneof.field(i)->name());
  return names;
}

}  // namespace

json ParseJson(std::string_view text, Problems& problems) {
  if (text.size() > kMaxSceneBytes) {
    problems.Add("", "the scene is larger than 16 MiB", "move meshes and fibres to separate files");
    return json(json::value_t::discarded);
  }
  DuplicateKeys duplicates(problems);
  try {
    return json::parse(text.begin(), text.end(), std::ref(duplicates), true, /*ignore_comments=*/true);
  } catch (const TooDeep&) {
    problems.Add("", "is nested deeper than " + std::to_string(kMaxDepth) + " levels");
  } catch (const json::parse_error& error) {
    problems.Add("", "JSON syntax error at " + PlaceOf(text, error.byte) + ": " + SyntaxMessage(error.what()));
  } catch (const json::exception& error) {
    problems.Add("", "JSON error: " + SyntaxMessage(error.what()));
  }
  return json(json::value_t::discarded);
}

std::string JsonText(const Message& message) {
  std::string text;
  Print(ObjectOf(message), 0, text);
  return text + "\n";
}

void ReadMessage(const json& value, Message& message, const std::string& path, Problems& problems) {
  const Descriptor& type = *message.GetDescriptor();
  if (!value.is_object()) {
    problems.Add(path, "expects an object of " + Join(FieldNames(type)) + ", got " + KindOfValue(value),
                 "write { ... }");
    return;
  }
  std::set<const OneofDescriptor*> given;
  for (const auto& [key, member] : value.items()) {
    const std::string member_path = JoinPath(path, key.size() > 64 ? key.substr(0, 64) + "..." : key);
    const FieldDescriptor* field = type.FindFieldByName(key);
    if (field == nullptr) {
      problems.Add(member_path, "unknown field", NameHint(key, FieldNames(type)));
      continue;
    }
    // Protobuf treats `optional` fields as oneofs with one member; these are skipped.
    const OneofDescriptor* oneof = field->real_containing_oneof();
    if (oneof != nullptr && !given.insert(oneof).second) {
      problems.Add(member_path, "only one of " + Join(MemberNames(*oneof)) + " may be given", "keep one of them");
      continue;
    }
    FieldReader(message, *field, problems).Read(member, member_path);
  }
}

}  // namespace fascicle::client
