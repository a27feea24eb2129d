#include "core/base/problems.h"

#include <utility>

namespace fascicle {

void Problems::Add(std::string path, std::string message, std::string hint) {
  ++count_;
  if (kept_.size() < kMaxKept) kept_.push_back({std::move(path), std::move(message), std::move(hint)});
}

void Problems::Append(std::string_view prefix, const Problems& other) {
  for (const Problem& problem : other.kept_) Add(JoinPath(prefix, problem.path), problem.message, problem.hint);
  count_ += other.count_ - other.kept_.size();
}

std::string Problems::ToString() const {
  std::string text;
  for (const Problem& problem : kept_) {
    if (!problem.path.empty()) text += problem.path + ": ";
    text += problem.message;
    if (!problem.hint.empty()) text += " (" + problem.hint + ")";
    text += '\n';
  }
  if (count_ > kept_.size()) text += "and " + std::to_string(count_ - kept_.size()) + " more\n";
  return text;
}

std::string JoinPath(std::string_view prefix, std::string_view field) {
  std::string path(prefix);
  if (!path.empty() && !field.empty() && field.front() != '[') path += '.';
  path += field;
  return path;
}

std::string IndexPath(std::string_view list, std::size_t index) {
  return std::string(list) + "[" + std::to_string(index) + "]";
}

}  // namespace fascicle
