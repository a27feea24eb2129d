#include "client/cli/input_file.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

namespace fascicle::client {

std::optional<std::string> ReadInputFile(const std::string& path, Problems& problems) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) {
    problems.Add("", "there is no such file", "is the path right?");
    return std::nullopt;
  }
  if (std::filesystem::is_directory(status)) {
    problems.Add("", "it is a folder", "give a file");
    return std::nullopt;
  }
  std::ifstream in(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  if (!in.is_open() || in.bad()) {
    problems.Add("", "it can't be read", "is there permission to read it?");
    return std::nullopt;
  }
  return bytes;
}

}  // namespace fascicle::client
