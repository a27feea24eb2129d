#include "server/jobs/crash_marks.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>

namespace fascicle::server {
namespace {

constexpr std::size_t kLongestId = 64;

// A signal handler may read these: a number, and bytes that only its own thread writes.
std::atomic<int> g_file = -1;
thread_local char t_line[kLongestId + 1];  // the id and a line feed
thread_local std::size_t t_size = 0;

extern "C" void OnCrash(int signal) {
  if (t_size > 0) [[maybe_unused]]
    const ssize_t written = write(g_file, t_line, t_size);
  raise(signal);  // its default action, which SA_RESETHAND has restored
}

}  // namespace

void RecordCrashes(const std::string& path) {
  g_file = open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  if (g_file < 0) return;
  struct sigaction action = {};
  action.sa_handler = &OnCrash;
  action.sa_flags = SA_RESETHAND | SA_NODEFER;
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) sigaction(signal, &action, nullptr);
}

std::vector<std::string> TakeCrashes(const std::string& path) {
  std::vector<std::string> ids;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (!line.empty() && line.size() <= kLongestId) ids.push_back(line);
  }
  std::error_code ignored;
  std::filesystem::resize_file(path, 0, ignored);
  return ids;
}

JobOnThisThread::JobOnThisThread(const std::string& id) {
  const std::size_t size = std::min(id.size(), kLongestId);
  std::memcpy(t_line, id.data(), size);
  t_line[size] = '\n';
  t_size = size + 1;
}

JobOnThisThread::~JobOnThisThread() { t_size = 0; }

}  // namespace fascicle::server
