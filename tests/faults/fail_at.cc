// A library to preload, which kills its process at a call on a file. FASCICLE_FAIL_AT says where: MOMENT CALL PATTERN
// NUMBER, as in "before fdatasync */control.db-wal 3": before the third fdatasync of a file with such a path. Moments
// are `before`, `after` and, of writes, `within`: then half of the bytes are written.
#include <dlfcn.h>
#include <fnmatch.h>
#include <sys/types.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <string>

namespace {

struct Failpoint {
  std::string moment, call, pattern;
  std::atomic<int> left = 0;
};

Failpoint* ReadFailpoint() {
  const char* const text = std::getenv("FASCICLE_FAIL_AT");
  if (text == nullptr) return nullptr;
  auto* const point = new Failpoint;  // for as long as the process is
  int number = 0;
  std::istringstream(text) >> point->moment >> point->call >> point->pattern >> number;
  point->left = number;
  return point;
}

// Null until the library is initialized, and without the variable.
Failpoint* failpoint = ReadFailpoint();

std::string PathOf(int descriptor) {
  std::array<char, 4096> path = {};
  const ssize_t size = readlink(("/proc/self/fd/" + std::to_string(descriptor)).c_str(), path.data(), path.size());
  return size <= 0 ? std::string() : std::string(path.data(), static_cast<std::size_t>(size));
}
std::string PathOf(const char* path) { return path; }

// Whether this call is the one.
template <class File>
bool IsReached(const char* call, File file) {
  if (failpoint == nullptr || failpoint->call != call) return false;
  return fnmatch(failpoint->pattern.c_str(), PathOf(file).c_str(), 0) == 0 && --failpoint->left == 0;
}

void DieAt(const char* moment) {
  if (failpoint->moment == moment) kill(getpid(), SIGKILL);
}

template <class Function>
Function* Next(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

// Makes a call, and dies before or after it if it is the one.
template <class File, class Call>
auto Make(const char* name, File file, const Call& call) {
  const bool is_reached = IsReached(name, file);
  if (is_reached) DieAt("before");
  const auto result = call();
  if (is_reached) DieAt("after");
  return result;
}

// The same of a write(size), which may also die within.
template <class Write>
ssize_t MakeWrite(const char* name, int descriptor, std::size_t size, const Write& write) {
  const bool is_reached = IsReached(name, descriptor);
  if (is_reached) DieAt("before");
  const bool is_cut = is_reached && failpoint->moment == "within";
  const ssize_t result = write(is_cut ? size / 2 : size);
  if (is_reached) DieAt("within");
  if (is_reached) DieAt("after");
  return result;
}

}  // namespace

extern "C" {

ssize_t write(int descriptor, const void* bytes, std::size_t size) {
  static auto* const next = Next<decltype(write)>("write");
  return MakeWrite("write", descriptor, size, [&](std::size_t count) { return next(descriptor, bytes, count); });
}

ssize_t pwrite64(int descriptor, const void* bytes, std::size_t size, off64_t offset) {
  static auto* const next = Next<decltype(pwrite64)>("pwrite64");
  return MakeWrite("pwrite", descriptor, size,
                   [&](std::size_t count) { return next(descriptor, bytes, count, offset); });
}

int fdatasync(int descriptor) {
  static auto* const next = Next<decltype(fdatasync)>("fdatasync");
  return Make("fdatasync", descriptor, [&] { return next(descriptor); });
}

int fsync(int descriptor) {
  static auto* const next = Next<decltype(fsync)>("fsync");
  return Make("fsync", descriptor, [&] { return next(descriptor); });
}

int ftruncate64(int descriptor, off64_t size) noexcept {
  static auto* const next = Next<decltype(ftruncate64)>("ftruncate64");
  return Make("ftruncate", descriptor, [&] { return next(descriptor, size); });
}

int rename(const char* from, const char* to) noexcept {
  static auto* const next = Next<decltype(rename)>("rename");
  return Make("rename", to, [&] { return next(from, to); });
}

int unlink(const char* path) noexcept {
  static auto* const next = Next<decltype(unlink)>("unlink");
  return Make("unlink", path, [&] { return next(path); });
}

int remove(const char* path) noexcept {
  static auto* const next = Next<decltype(remove)>("remove");
  return Make("unlink", path, [&] { return next(path); });
}

}  // extern "C"
