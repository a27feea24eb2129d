#ifndef FASCICLE_SERVER_TRANSLATE_NAMES_H_
#define FASCICLE_SERVER_TRANSLATE_NAMES_H_

#include <cstddef>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/base/problems.h"

namespace fascicle::server {

// The names of a list's entries (bodies, regions, probes): their syntax, uniqueness, and references to them.
class Names {
 public:
  // `what` names an entry in messages: "region".
  explicit Names(std::string what) : what_(std::move(what)) {}

  // Adds the name of the next entry, which is at `path`. Adds a problem if it is malformed or already used.
  void Add(const std::string& name, const std::string& path, Problems& problems);
  // The entry to which the reference at `path` refers; a problem with the nearest name if there is none. (Problems that
  // are only counted get no hint, because finding it takes long.)
  std::optional<std::size_t> Find(const std::string& name, const std::string& path, Problems& problems) const;

 private:
  std::string Hint(const std::string& name) const;
  // The most similar name, for a misspelt one; empty if none is similar.
  std::string Nearest(const std::string& name) const;

  std::string what_;
  std::vector<std::string> names_;
  std::unordered_map<std::string, std::size_t> indices_;  // of the first entry of each name
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_NAMES_H_
