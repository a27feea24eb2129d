#ifndef FASCICLE_TESTS_DETERMINISM_GOLDEN_H_
#define FASCICLE_TESTS_DETERMINISM_GOLDEN_H_

#include <filesystem>
#include <string>
#include <vector>

// Reads the digests of the examples in golden_digests.txt. Thread-safe.
namespace fascicle::testing {

// A line of the file.
struct GoldenScene {
  std::string name;
  bool is_slow = false;
  std::string digest;
};

std::filesystem::path GoldenFile();
// Throws std::runtime_error with the first malformed line.
std::vector<GoldenScene> ReadGolden();
// The whole file, including its explanation.
std::string GoldenText(const std::vector<GoldenScene>& scenes);

// Names of the built-in examples, ascending.
std::vector<std::string> ExampleNames();

struct GoldenRun {
  std::string digest;   // SHA-256 of the digests of all frames in hexadecimal, one line each; empty if there is none
  std::string missing;  // a file of the scene that is not on this machine
  std::string problem;  // why there is none
};
// Runs a built-in example by `fascicle run` on one thread.
GoldenRun RunGolden(const std::string& name);

// The reason why digests cannot be compared on this machine; empty if they can.
std::string WhyNotComparable();

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_DETERMINISM_GOLDEN_H_
