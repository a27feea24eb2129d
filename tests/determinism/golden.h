#ifndef FASCICLE_TESTS_DETERMINISM_GOLDEN_H_
#define FASCICLE_TESTS_DETERMINISM_GOLDEN_H_

#include <filesystem>
#include <string>
#include <vector>

// The digests that the examples had when golden_digests.txt was last written. Thread-safe.
namespace fascicle::testing {

// A line of the file.
struct GoldenScene {
  std::string name;
  bool is_slow = false;
  std::string digest;
};

std::filesystem::path GoldenFile();
// Throws std::runtime_error with the line that can't be read.
std::vector<GoldenScene> ReadGolden();
// The whole file, its explanation included.
std::string GoldenText(const std::vector<GoldenScene>& scenes);

// Names of the built-in examples, ascending.
std::vector<std::string> ExampleNames();

struct GoldenRun {
  std::string digest;   // SHA-256 of the digests of all frames in hexadecimal, a line each; empty without an answer
  std::string missing;  // a file of the scene that is not on this machine
  std::string problem;  // why there is no answer
};
// Runs a built-in example by `fascicle run` on one thread.
GoldenRun RunGolden(const std::string& name);

// Why digests can't be compared on this machine; empty if they can.
std::string WhyNotComparable();

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_DETERMINISM_GOLDEN_H_
