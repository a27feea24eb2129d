#ifndef FASCICLE_CLIENT_IMPORT_OSIM_IMPORT_H_
#define FASCICLE_CLIENT_IMPORT_OSIM_IMPORT_H_

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "client/import/febio_import.h"
#include "core/base/problems.h"

namespace fascicle::client {

struct OsimOptions {
  // Name of the model file in messages.
  std::string name = "model.osim";
  // The bytes of a surface of a bone by the name that the model gives; nothing if there is no such file.
  std::function<std::optional<std::string>(const std::string& file)> surface;
  // The motion (.mot or .sto), if there is one.
  std::optional<ImportedFile> motion;
  // Of a motion [Hz]; 0: its noise is kept. Only of motions with equal intervals.
  double low_pass = 6;
  // Whether to import a model although the scene lacks or changes parts of it that change the answer; if not, each of
  // them is a problem.
  bool accept_loss = false;
};

// Makes a scene of an OpenSim model (osim_reader.h), without bodies: its skeleton, its gravity, the motion, and the
// activations that exert its torques. The files are the bones' surfaces and the motion. All problems are added at once,
// with lines. Any input is safe. Thread-safe.
std::optional<ImportedScene> ImportOsim(std::string_view bytes, const OsimOptions& options, Problems& problems);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_IMPORT_OSIM_IMPORT_H_
