#include "client/lib/replace_file.h"

#include <unistd.h>

#include <fstream>
#include <stdexcept>
#include <string>
#include <system_error>

namespace fascicle::client {

namespace fs = std::filesystem;

void ReplaceFile(const fs::path& path, const std::function<void(const fs::path&)>& write) {
  const auto fail = [&](const std::string& why) {
    throw std::runtime_error("can't write " + path.string() + ": " + why);
  };
  std::error_code error;
  if (path.has_parent_path()) fs::create_directories(path.parent_path(), error);
  if (error) fail(error.message());
  if (fs::is_directory(path, error)) fail("it is a folder");
  // The extension is kept, since some writers depend on it; the process id distinguishes two programs.
  const fs::path beside =
      path.parent_path() / ("." + path.stem().string() + "." + std::to_string(getpid()) + path.extension().string());
  try {
    write(beside);
  } catch (...) {
    fs::remove(beside, error);
    throw;
  }
  fs::rename(beside, path, error);
  if (error) {
    const std::string why = error.message();
    fs::remove(beside, error);
    fail(why);
  }
}

void ReplaceFile(const fs::path& path, std::string_view content) {
  ReplaceFile(path, [&](const fs::path& beside) {
    std::ofstream out(beside, std::ios::binary);
    out.write(content.data(), static_cast<std::streamsize>(content.size()));
    out.close();
    if (!out) throw std::runtime_error("can't write " + path.string() + ": no permission, or no space left");
  });
}

}  // namespace fascicle::client
