#include <algorithm>
#include <iostream>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>

#include <google/protobuf/descriptor.h>

#include "client/cli/command.h"
#include "core/base/letters.h"
#include "fascicle/v1/scene.pb.h"
#include "proto/rules/enum_names.h"
#include "proto/rules/field_rules.h"

namespace fascicle::client {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::EnumDescriptor;
using google::protobuf::FieldDescriptor;

constexpr const char* kSchemaExamples = R"(  fascicle schema                     all fields of a scene
  fascicle schema Body                one message; also by field name: `fascicle schema fusiform`
  fascicle schema strain              a word that is no name: every field and value that mentions it
  fascicle schema --json              the same for programs, one object for each message and enum
)";

constexpr const char* kHeading =
    R"(A scene file is JSON with // and /* */ comments: an object with the fields of Scene below. Names of choices are short and
lower-case ("mm", "mixed"). Lists of fixed length are written [x, y, z]. Give exactly one of the fields marked `one of`.

)";

// The messages and enums of a scene, in the order in which they are referred to.
struct Types {
  std::vector<const Descriptor*> messages;
  std::vector<const EnumDescriptor*> enums;
};

void Collect(const Descriptor& message, Types& types) {
  if (std::find(types.messages.begin(), types.messages.end(), &message) != types.messages.end()) return;
  types.messages.push_back(&message);
  for (int i = 0; i < message.field_count(); ++i) {
    if (const EnumDescriptor* type = message.field(i)->enum_type()) {
      if (std::find(types.enums.begin(), types.enums.end(), type) == types.enums.end()) types.enums.push_back(type);
    }
  }
  for (int i = 0; i < message.field_count(); ++i) {
    if (const Descriptor* type = message.field(i)->message_type()) Collect(*type, types);
  }
}

std::string Names(const EnumDescriptor& type) {
  std::string names;
  for (int i = 1; i < type.value_count(); ++i) names += (i > 1 ? ", " : "") + ("\"" + NameOf(*type.value(i)) + "\"");
  return names;
}

std::string KindOf(const FieldDescriptor& field) {
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_MESSAGE:
      return field.message_type()->name();
    case FieldDescriptor::CPPTYPE_ENUM:
      return field.enum_type()->name();
    case FieldDescriptor::CPPTYPE_STRING:
      return "text";
    case FieldDescriptor::CPPTYPE_BOOL:
      return "true or false";
    case FieldDescriptor::CPPTYPE_DOUBLE:
    case FieldDescriptor::CPPTYPE_FLOAT:
      return "number";
    default:
      return "whole number";
  }
}

std::string TypeText(const FieldDescriptor& field, const std::optional<FieldRule>& rule) {
  if (!field.is_repeated()) return KindOf(field);
  return rule && rule->values > 0 ? "list of " + std::to_string(rule->values) + " " + KindOf(field) + "s"
                                  : "list of " + KindOf(field);
}

void PrintIndented(const std::string& text, const std::string& indent) {
  std::size_t start = 0;
  while (start < text.size()) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    std::cout << indent << text.substr(start, end - start) << '\n';
    start = end + 1;
  }
}

void PrintField(const FieldDescriptor& field) {
  const std::optional<FieldRule> rule = RuleOf(field);
  std::string line = "  " + field.name() + ": " + TypeText(field, rule);
  if (rule) {
    if (rule->unit != "1") line += " [" + rule->unit + "]";
    line += ", " + rule->range_text;
    if (rule->required) line += ", required";
    if (!rule->default_text.empty()) line += ", default " + rule->default_text;
    if (!rule->required && rule->default_text.empty()) line += ", optional";
  }
  if (const auto* oneof = field.real_containing_oneof()) line += "   (one of `" + oneof->name() + "`)";
  std::cout << line << '\n';
  PrintIndented(CommentOf(field), "      ");
}

void PrintMessage(const Descriptor& message) {
  std::cout << message.name() << '\n';
  PrintIndented(CommentOf(message), "  | ");
  for (int i = 0; i < message.field_count(); ++i) PrintField(*message.field(i));
  std::cout << '\n';
}

void PrintEnum(const EnumDescriptor& type) {
  std::cout << type.name() << ": one of " << Names(type) << '\n';
  PrintIndented(CommentOf(type), "  | ");
  for (int i = 1; i < type.value_count(); ++i) {
    std::cout << "  \"" << NameOf(*type.value(i)) << "\"\n";
    PrintIndented(CommentOf(*type.value(i)), "      ");
  }
  std::cout << '\n';
}

Json FieldJson(const FieldDescriptor& field) {
  const std::optional<FieldRule> rule = RuleOf(field);
  Json json = {{"name", field.name()}, {"type", KindOf(field)}, {"list", field.is_repeated()}};
  if (const auto* oneof = field.real_containing_oneof()) json["one_of"] = oneof->name();
  if (rule) {
    json["unit"] = rule->unit;
    if (rule->values > 0) json["values"] = rule->values;
    json["range"] = rule->range_text;
    json["required"] = rule->required;
    if (!rule->default_text.empty()) {
      json["default"] =
          rule->defaults.size() == 1 && rule->values == 0 ? Json(rule->defaults[0]) : Json(rule->defaults);
    }
  }
  json["comment"] = CommentOf(field);
  return json;
}

Json MessageJson(const Descriptor& message) {
  Json fields = Json::array();
  for (int i = 0; i < message.field_count(); ++i) fields.push_back(FieldJson(*message.field(i)));
  return {{"message", message.name()}, {"comment", CommentOf(message)}, {"fields", std::move(fields)}};
}

Json EnumJson(const EnumDescriptor& type) {
  Json values = Json::array();
  for (int i = 1; i < type.value_count(); ++i) {
    values.push_back({{"name", NameOf(*type.value(i))}, {"comment", CommentOf(*type.value(i))}});
  }
  return {{"enum", type.name()}, {"comment", CommentOf(type)}, {"values", std::move(values)}};
}

// Keeps the types called `name`, or the type of a field called so. Returns false if there is none.
bool Select(const std::string& name, Types& types) {
  std::set<const void*> wanted;
  for (const Descriptor* message : types.messages) {
    if (Lower(message->name()) == Lower(name)) wanted.insert(message);
  }
  for (const EnumDescriptor* type : types.enums) {
    if (Lower(type->name()) == Lower(name)) wanted.insert(type);
  }
  for (const Descriptor* message : types.messages) {
    if (!wanted.empty()) break;
    const FieldDescriptor* field = message->FindFieldByName(Lower(name));
    if (field == nullptr) continue;
    wanted.insert(field->message_type() != nullptr ? static_cast<const void*>(field->message_type())
                  : field->enum_type() != nullptr  ? static_cast<const void*>(field->enum_type())
                                                   : static_cast<const void*>(message));
  }
  if (wanted.empty()) return false;
  std::erase_if(types.messages, [&](const Descriptor* message) { return !wanted.contains(message); });
  std::erase_if(types.enums, [&](const EnumDescriptor* type) { return !wanted.contains(type); });
  return true;
}

// A field or a value that mentions a word, and the message or enum that it belongs to.
struct Mention {
  std::string of;
  std::string name;
  std::string comment;
};

// Whether `text` has `wanted` at the beginning of a word: "strain" is not in "constraints".
bool HasWord(const std::string& text, const std::string& wanted) {
  for (std::size_t at = text.find(wanted); at != std::string::npos; at = text.find(wanted, at + 1)) {
    if (at == 0 || text[at - 1] < 'a' || text[at - 1] > 'z') return true;
  }
  return false;
}

// What has `word` in its name or comment, in any case; `_` counts as a blank.
std::vector<Mention> Search(const std::string& word, const Types& types) {
  const auto spoken = [](std::string text) {
    std::replace(text.begin(), text.end(), '_', ' ');
    return Lower(text);
  };
  const std::string wanted = spoken(word);
  std::vector<Mention> mentions;
  const auto add = [&](const std::string& of, const std::string& name, const std::string& comment) {
    if (HasWord(spoken(name + "\n" + comment), wanted)) mentions.push_back({of, name, comment});
  };
  for (const Descriptor* message : types.messages) {
    for (int i = 0; i < message->field_count(); ++i) {
      add(message->name(), message->field(i)->name(), CommentOf(*message->field(i)));
    }
  }
  for (const EnumDescriptor* type : types.enums) {
    for (int i = 1; i < type->value_count(); ++i) {
      add(type->name(), "\"" + NameOf(*type->value(i)) + "\"", CommentOf(*type->value(i)));
    }
  }
  return mentions;
}

int PrintMentions(const std::string& word, const Types& types, const Context& context) {
  const std::vector<Mention> mentions = Search(word, types);
  if (mentions.empty()) {
    std::string known;
    for (const Descriptor* message : types.messages) known += (known.empty() ? "" : ", ") + message->name();
    throw CommandError::Invalid("a scene has no `" + word + "`; known names: " + known);
  }
  for (const Mention& mention : mentions) {
    if (context.json) {
      PrintJson({{"of", mention.of}, {"name", mention.name}, {"comment", mention.comment}});
      continue;
    }
    std::cout << mention.of << ": " << mention.name << '\n';
    PrintIndented(mention.comment, "      ");
  }
  if (!context.json) std::cout << "\n`fascicle schema NAME` prints all of one of these.\n";
  return kDone;
}

int Schema(const std::string& name, const Context& context) {
  Types types;
  Collect(*v1::Scene::descriptor(), types);
  if (!name.empty() && !Select(name, types)) return PrintMentions(name, types, context);
  if (context.json) {
    for (const Descriptor* message : types.messages) PrintJson(MessageJson(*message));
    for (const EnumDescriptor* type : types.enums) PrintJson(EnumJson(*type));
    return kDone;
  }
  if (name.empty()) std::cout << kHeading;
  for (const Descriptor* message : types.messages) PrintMessage(*message);
  for (const EnumDescriptor* type : types.enums) PrintEnum(*type);
  return kDone;
}

}  // namespace

void AddSchema(CLI::App& app, Context& context) {
  CLI::App* command = AddCommand(app, "schema", "The fields of a scene: units, ranges, defaults", kSchemaExamples);
  const auto name = std::make_shared<std::string>();
  command->add_option("NAME", *name, "A message, an enum or a field; or a word to search for");
  command->callback([name, &context] { context.action = [name, &context] { return Schema(*name, context); }; });
}

}  // namespace fascicle::client
