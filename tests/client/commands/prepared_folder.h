#ifndef FASCICLE_TESTS_CLIENT_COMMANDS_PREPARED_FOLDER_H_
#define FASCICLE_TESTS_CLIENT_COMMANDS_PREPARED_FOLDER_H_

#include <filesystem>
#include <string>

namespace fascicle::testing {

// Writes the files that the lines of the documents read and `fascicle` does not make: scenes, surfaces, meshes and
// models of other programs, label images, a DICOM series and measured curves.
void WriteInputs(const std::filesystem::path& folder);

// A scene that takes milliseconds, and one that runs until it is cancelled.
std::string QuickScene();
std::string EndlessScene();
// Endless, too, with everything that can be steered.
std::string SteeredScene();

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_CLIENT_COMMANDS_PREPARED_FOLDER_H_
