#ifndef FASCICLE_PROTO_RULES_PARSE_RULE_H_
#define FASCICLE_PROTO_RULES_PARSE_RULE_H_

#include <optional>
#include <string>
#include <string_view>

#include "proto/rules/field_rules.h"

namespace fascicle {

// A field's comment, taken apart.
struct SplitComment {
  std::string text;  // without the rule line; lines joined by '\n', no leading blanks
  std::string rule;  // the last line, where it is "Unit ...; range ..."; empty when it is not
};
SplitComment Split(std::string_view comment);

// Reads one rule line. Nothing when it does not follow the grammar of field_rules.h to the letter.
std::optional<FieldRule> ParseRule(std::string_view line);

}  // namespace fascicle

#endif  // FASCICLE_PROTO_RULES_PARSE_RULE_H_
