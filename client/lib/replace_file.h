#ifndef FASCICLE_CLIENT_LIB_REPLACE_FILE_H_
#define FASCICLE_CLIENT_LIB_REPLACE_FILE_H_

#include <filesystem>
#include <functional>
#include <string_view>

namespace fascicle::client {

// Makes or replaces a file so that nobody ever sees half of it: `write` fills a new file beside it, which then takes
// its name. Folders are made as needed. Throws std::runtime_error with a message for people; then the old file, if
// there was one, is untouched and nothing is left beside it.
void ReplaceFile(const std::filesystem::path& path,
                 const std::function<void(const std::filesystem::path& beside)>& write);

// The same with the content at hand.
void ReplaceFile(const std::filesystem::path& path, std::string_view content);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_LIB_REPLACE_FILE_H_
