#ifndef FASCICLE_SERVER_TRANSLATE_NAMES_H_
#define FASCICLE_SERVER_TRANSLATE_NAMES_H_

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/base/problems.h"

namespace fascicle::server {

// The names of a list's entries (bodies, regions, probes): their pattern, uniqueness, and references to them.
class Names {
 public:
  // `what` is for messages: "region".
  explicit Names(std::string what) : what_(std::move(what)) {}

  // The name of the next entry, which stands at `path`. Adds a problem when it is malformed or taken.
  void Add(const std::string& name, const std::string& path, Problems& problems);
  // The entry that the reference at `path` means; a problem with the nearest name when there is none.
  std::optional<std::size_t> Find(const std::string& name, const std::string& path, Problems& problems) const;

 private:
  std::string Hint(const std::string& name) const;

  std::string what_;
  std::vector<std::string> names_;
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_NAMES_H_
