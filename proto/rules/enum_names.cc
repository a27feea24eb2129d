#include "proto/rules/enum_names.h"

#include <algorithm>
#include <cctype>

#include "core/base/letters.h"

namespace fascicle {

std::string NameOf(const google::protobuf::EnumValueDescriptor& value) {
  const std::string& type = value.type()->name();
  std::size_t prefix = type.size() + 1;  // one `_` between words and one at the end
  for (std::size_t i = 1; i < type.size(); ++i) prefix += std::isupper(static_cast<unsigned char>(type[i])) ? 1 : 0;
  std::string name = value.name().substr(std::min(prefix, value.name().size()));
  return Lower(name);
}

}  // namespace fascicle
