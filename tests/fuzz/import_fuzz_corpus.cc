// import_fuzz_corpus FOLDER: writes the models of the importer's tests as inputs of import_fuzz.
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "tests/support/sample_models.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: import_fuzz_corpus FOLDER\n");
    return 2;
  }
  std::filesystem::create_directories(argv[1]);
  std::ofstream(std::filesystem::path(argv[1]) / "small.feb", std::ios::binary)
      << '\0' << fascicle::testing::kSmallModel;
  std::ofstream(std::filesystem::path(argv[1]) / "rich.feb", std::ios::binary)
      << '\x9' << fascicle::testing::kRichModel;
  return 0;
}
