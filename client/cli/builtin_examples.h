#ifndef FASCICLE_CLIENT_CLI_BUILTIN_EXAMPLES_H_
#define FASCICLE_CLIENT_CLI_BUILTIN_EXAMPLES_H_

#include <span>
#include <string_view>

namespace fascicle::client {

// A file of client/examples as it was when the program was built.
struct BuiltinFile {
  std::string_view name;  // "fusiform_isometric.json"
  std::string_view content;
};

std::span<const BuiltinFile> BuiltinExamples();

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_CLI_BUILTIN_EXAMPLES_H_
