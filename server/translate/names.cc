#include "server/translate/names.h"

#include <algorithm>

#include "core/base/edit_distance.h"

namespace fascicle::server {
namespace {

constexpr std::size_t kMaxLength = 64;
constexpr std::size_t kMaxListed = 10;
const char kSyntax[] = "letters, digits, `_`, `-` and `.`, 1 to 64 characters";

bool IsNameCharacter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '.';
}

// Files are named after names, so a name must not denote a folder.
bool IsName(const std::string& name) {
  return !name.empty() && name.size() <= kMaxLength && std::all_of(name.begin(), name.end(), IsNameCharacter) &&
         name != "." && name != "..";
}

std::string Shortened(const std::string& name) {
  return name.size() <= kMaxLength ? name : name.substr(0, kMaxLength) + "...";
}

}  // namespace

void Names::Add(const std::string& name, const std::string& path, Problems& problems) {
  if (name.empty()) {
    problems.Add(path, "is missing", kSyntax);
  } else if (!IsName(name)) {
    problems.Add(path, "'" + Shortened(name) + "' is not a name", kSyntax);
  } else if (indices_.contains(name)) {
    problems.Add(path, "'" + name + "' is already the name of another " + what_,
                 "every " + what_ + " needs a unique name");
  }
  indices_.try_emplace(name, names_.size());
  names_.push_back(name);
}

std::optional<std::size_t> Names::Find(const std::string& name, const std::string& path, Problems& problems) const {
  const auto found = indices_.find(name);
  if (!name.empty() && found != indices_.end()) return found->second;
  problems.Add(path, name.empty() ? "is missing" : "there is no " + what_ + " '" + Shortened(name) + "'",
               problems.count() < Problems::kMaxKept ? Hint(name) : std::string());
  return std::nullopt;
}

std::string Names::Nearest(const std::string& name) const {
  constexpr std::size_t kMaxCompared = 1000;
  std::string nearest;
  std::size_t least = kMaxLength;
  for (std::size_t i = 0; i < std::min(names_.size(), kMaxCompared) && !name.empty(); ++i) {
    const std::size_t distance = EditDistance(name.substr(0, kMaxLength), Shortened(names_[i]));
    if (distance >= least) continue;
    least = distance;
    nearest = names_[i];
  }
  return least <= std::max<std::size_t>(2, nearest.size() / 3) ? nearest : std::string();
}

std::string Names::Hint(const std::string& name) const {
  if (names_.empty()) return "there is no " + what_ + " at all";
  std::string hint;
  if (const std::string nearest = Nearest(name); !nearest.empty()) hint = "did you mean '" + nearest + "'? ";
  hint += "known: ";
  for (std::size_t i = 0; i < std::min(names_.size(), kMaxListed); ++i) {
    hint += (i > 0 ? ", '" : "'") + Shortened(names_[i]) + "'";
  }
  return names_.size() > kMaxListed ? hint + ", ..." : hint;
}

}  // namespace fascicle::server
