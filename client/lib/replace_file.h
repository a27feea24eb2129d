#ifndef FASCICLE_CLIENT_LIB_REPLACE_FILE_H_
#define FASCICLE_CLIENT_LIB_REPLACE_FILE_H_

#include <filesystem>
#include <functional>
#include <string_view>

namespace fascicle::client {

// Creates or replaces a file atomically: `write` fills a new file beside it, which is then renamed. Creates folders as
// needed. Throws std::runtime_error with a message for users; the old file, if any, is then unchanged and nothing is
// left beside it.
void ReplaceFile(const std::filesystem::path& path,
                 const std::function<void(const std::filesystem::path& beside)>& write);

// The same with given content.
void ReplaceFile(const std::filesystem::path& path, std::string_view content);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_LIB_REPLACE_FILE_H_
