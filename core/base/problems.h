#ifndef FASCICLE_CORE_BASE_PROBLEMS_H_
#define FASCICLE_CORE_BASE_PROBLEMS_H_

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace fascicle {

// An error in a user's input.
struct Problem {
  std::string path;     // field, such as `bodies[0].mesh`; empty for the whole input
  std::string message;  // what is wrong, in plain words
  std::string hint;     // how to mend it; may be empty

  bool operator==(const Problem&) const = default;
};

// Collects all errors of an input, so that a user sees them together. A function that reads user input takes a
// Problems, adds to it and continues as far as is sensible; the caller checks `empty()` at the end.
// Keeps the first kMaxKept and counts the rest. Not thread-safe.
class Problems {
 public:
  static constexpr std::size_t kMaxKept = 200;

  void Add(std::string path, std::string message, std::string hint = {});
  // Adds all problems of `other` with `prefix` before their paths: "bodies[0]" and "mesh" give "bodies[0].mesh".
  void Append(std::string_view prefix, const Problems& other);

  bool empty() const { return kept_.empty(); }
  const std::vector<Problem>& kept() const { return kept_; }
  // Number of problems added, including those not kept.
  std::size_t count() const { return count_; }
  // One line each: `path: message (hint)`.
  std::string ToString() const;

 private:
  std::vector<Problem> kept_;
  std::size_t count_ = 0;
};

// Joins two parts of a field path: ("bodies[0]", "mesh") -> "bodies[0].mesh"; an empty part adds nothing.
std::string JoinPath(std::string_view prefix, std::string_view field);
// ("bodies", 2) -> "bodies[2]".
std::string IndexPath(std::string_view list, std::size_t index);

}  // namespace fascicle

#endif  // FASCICLE_CORE_BASE_PROBLEMS_H_
