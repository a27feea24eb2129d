#ifndef FASCICLE_CLIENT_IMPORT_FEBIO_IMPORT_H_
#define FASCICLE_CLIENT_IMPORT_FEBIO_IMPORT_H_

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/problems.h"
#include "fascicle/v1/scene.pb.h"

namespace fascicle::client {

// Something that an import says beside what it gives.
struct Notice {
  enum class Kind {
    kNotTaken,  // of the model, and missing in the scene
    kChanged,   // in the scene, but not quite what the model says
    kSetting,   // how to solve and what to write: fascicle's own way is taken
  };
  Kind kind = Kind::kNotTaken;
  int line = 0;
  std::string where;  // "model.feb:120: Contact/contact \"c1\""
  std::string message;
};

struct FebioOptions {
  // What names the file in messages.
  std::string name = "model.feb";
  // SI, mm-N-s, mm-kg-s, um-nN-s or CGS, or mm-N-MPa for mm-N-s and m-N-Pa for SI. When empty: what the file says, and
  // mm-N-s when it says nothing.
  std::string units;
  // Split hexahedra, wedges and pyramids into tetrahedra instead of refusing them. Neighbours fit together.
  bool split_hexahedra = false;
};

struct ImportedFile {
  std::string name;
  std::string bytes;
};

// A scene, the files that it names, and what has to be said of both.
struct ImportedScene {
  v1::Scene scene;
  std::vector<ImportedFile> files;
  std::vector<Notice> notices;
  std::string units;
  std::string version;
};

// Reads a FEBio model (febio_spec 4.0 or 3.0): tetrahedra of four and ten nodes, the materials of scene.proto, fixed
// and prescribed displacements, nodal forces, tractions, pressures, constant body forces, fibres, load curves, one
// analysis step. Each part of the mesh that shares no face with the others becomes a body of its own.
//
// All problems are added at once, each with file, line and element. Any bytes are safe: nothing crashes, hangs or takes
// more memory than a small multiple of the file, and no other file is read. What of the model is not in the scene
// stands in `notices`, in the order of the file.
//
// Source: FEBio User Manual 4, chapter 3; FEBio Feature Manual. Thread-safe.
std::optional<ImportedScene> ImportFebio(std::string_view bytes, const FebioOptions& options, Problems& problems);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_IMPORT_FEBIO_IMPORT_H_
