// mesh_fuzz_corpus FOLDER: writes the small files of the readers' tests as inputs of mesh_fuzz.
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "tests/support/mesh_samples.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: mesh_fuzz_corpus FOLDER\n");
    return 2;
  }
  std::filesystem::create_directories(argv[1]);
  for (const fascicle::MeshSample& sample : fascicle::MeshSamples()) {
    const std::string extension = std::filesystem::path(sample.name).extension();
    const char format = extension == ".msh"    ? '\0'
                        : extension == ".vtu"  ? '\1'
                        : extension == ".vtk"  ? '\2'
                        : extension == ".mesh" ? '\3'
                                               : '\4';
    std::ofstream file(std::filesystem::path(argv[1]) / sample.name, std::ios::binary);
    file << format << sample.bytes;
    if (!sample.element_bytes.empty()) file << '\0' << sample.element_bytes;
  }
  return 0;
}
