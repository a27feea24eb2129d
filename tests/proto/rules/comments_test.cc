#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "fascicle/v1/frame.pb.h"
#include "fascicle/v1/job.pb.h"
#include "fascicle/v1/scene.pb.h"
#include "fascicle/v1/simulation_service.pb.h"
#include "proto/rules/field_rules.h"

namespace fascicle {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::EnumDescriptor;
using google::protobuf::FieldDescriptor;

// Whether a message is part of scenes.
bool IsOfScenes(const Descriptor& message) {
  return message.file() == v1::Scene::descriptor()->file() || message.file() == v1::ImageShape::descriptor()->file() ||
         message.file() == v1::FileRef::descriptor()->file();
}

void CollectEnum(const EnumDescriptor* type, std::vector<const EnumDescriptor*>& enums) { enums.push_back(type); }

void CollectMessage(const Descriptor* message, std::vector<const Descriptor*>& messages,
                    std::vector<const EnumDescriptor*>& enums) {
  messages.push_back(message);
  for (int i = 0; i < message->enum_type_count(); ++i) CollectEnum(message->enum_type(i), enums);
  for (int i = 0; i < message->nested_type_count(); ++i) CollectMessage(message->nested_type(i), messages, enums);
}

class CommentsTest : public ::testing::Test {
 protected:
  CommentsTest() {
    for (const auto* file :
         {v1::Scene::descriptor()->file(), v1::FileRef::descriptor()->file(), v1::ImageShape::descriptor()->file(),
          v1::Frame::descriptor()->file(), v1::Job::descriptor()->file(), v1::CreateJobRequest::descriptor()->file()}) {
      for (int i = 0; i < file->message_type_count(); ++i) CollectMessage(file->message_type(i), messages_, enums_);
      for (int i = 0; i < file->enum_type_count(); ++i) CollectEnum(file->enum_type(i), enums_);
    }
  }

  std::vector<const Descriptor*> messages_;
  std::vector<const EnumDescriptor*> enums_;
};

TEST_F(CommentsTest, EverythingIsCommented) {
  EXPECT_GT(messages_.size(), 60u);
  for (const Descriptor* message : messages_) {
    if (message->options().map_entry()) continue;  // made by protoc for a map
    EXPECT_NE(CommentOf(*message), "") << message->full_name();
    for (int i = 0; i < message->field_count(); ++i) {
      EXPECT_NE(CommentOf(*message->field(i)), "") << message->field(i)->full_name();
    }
  }
  for (const EnumDescriptor* type : enums_) {
    EXPECT_NE(CommentOf(*type), "") << type->full_name();
    for (int i = 0; i < type->value_count(); ++i) {
      EXPECT_NE(CommentOf(*type->value(i)), "") << type->value(i)->full_name();
    }
  }
}

TEST_F(CommentsTest, EveryNumberOfASceneHasARule) {
  // Documented elsewhere: a curve's values where the curve is used; any tag may occur in a mesh.
  const std::set<std::string> exempt = {"fascicle.v1.Curve.values", "fascicle.v1.Region.physical_tag"};
  int with_rule = 0;
  for (const Descriptor* message : messages_) {
    if (!IsOfScenes(*message)) continue;
    for (int i = 0; i < message->field_count(); ++i) {
      const FieldDescriptor& field = *message->field(i);
      const bool number =
          field.cpp_type() == FieldDescriptor::CPPTYPE_DOUBLE || field.cpp_type() == FieldDescriptor::CPPTYPE_INT32;
      EXPECT_EQ(RuleOf(field).has_value(), number && exempt.count(field.full_name()) == 0) << field.full_name();
      with_rule += RuleOf(field).has_value();
    }
  }
  EXPECT_GT(with_rule, 60);
}

// A scene has no kind of number that the rules do not know.
TEST_F(CommentsTest, ScenesUseDoubleAndInt32Only) {
  for (const Descriptor* message : messages_) {
    if (!IsOfScenes(*message)) continue;
    for (int i = 0; i < message->field_count(); ++i) {
      switch (message->field(i)->cpp_type()) {
        case FieldDescriptor::CPPTYPE_DOUBLE:
        case FieldDescriptor::CPPTYPE_INT32:
        case FieldDescriptor::CPPTYPE_BOOL:  // not a number: needs no rule
        case FieldDescriptor::CPPTYPE_ENUM:
        case FieldDescriptor::CPPTYPE_STRING:
        case FieldDescriptor::CPPTYPE_MESSAGE:
          break;
        default:
          ADD_FAILURE() << message->field(i)->full_name();
      }
    }
  }
}

TEST_F(CommentsTest, DefaultsLieInTheirRanges) {
  for (const Descriptor* message : messages_) {
    for (int i = 0; i < message->field_count(); ++i) {
      const auto rule = RuleOf(*message->field(i));
      if (!rule) continue;
      for (const double value : rule->defaults) {
        EXPECT_TRUE(rule->min_open ? value > rule->min : value >= rule->min) << message->field(i)->full_name();
        EXPECT_TRUE(rule->max_open ? value < rule->max : value <= rule->max) << message->field(i)->full_name();
      }
    }
  }
}

TEST_F(CommentsTest, TextsComeWithoutTheRule) {
  EXPECT_EQ(CommentOf(*v1::Body::descriptor()->FindFieldByName("density")), "Mass per rest volume.");
  EXPECT_EQ(CommentOf(*v1::LengthUnit_descriptor()->FindValueByName("LENGTH_UNIT_MM")), "Millimetre.");
  EXPECT_EQ(CommentOf(*v1::Stepping_descriptor()), "Time stepping of the tet method.");
}

}  // namespace
}  // namespace fascicle
