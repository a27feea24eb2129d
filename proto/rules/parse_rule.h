#ifndef FASCICLE_PROTO_RULES_PARSE_RULE_H_
#define FASCICLE_PROTO_RULES_PARSE_RULE_H_

#include <optional>
#include <string>
#include <string_view>

#include "proto/rules/field_rules.h"

namespace fascicle {

// A field's comment and its rule line.
struct SplitComment {
  std::string text;  // without the rule line; lines joined by '\n', no leading blanks
  std::string rule;  // the last line, if it is "Unit ...; range ..."; otherwise empty
};
SplitComment Split(std::string_view comment);

// Parses a rule line. Nothing if it deviates from the grammar of field_rules.h.
std::optional<FieldRule> ParseRule(std::string_view line);

}  // namespace fascicle

#endif  // FASCICLE_PROTO_RULES_PARSE_RULE_H_
