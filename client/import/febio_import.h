#ifndef FASCICLE_CLIENT_IMPORT_FEBIO_IMPORT_H_
#define FASCICLE_CLIENT_IMPORT_FEBIO_IMPORT_H_

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/problems.h"
#include "fascicle/v1/scene.pb.h"

namespace fascicle::client {

// A remark of an import in addition to its result.
struct Notice {
  enum class Kind {
    kNotTaken,  // part of the model that the scene lacks: a loss
    kChanged,   // in the scene, but not exactly as in the model: a loss
    kNote,      // what does not change the answer: solver and output settings, assumptions
  };
  Kind kind = Kind::kNotTaken;
  int line = 0;
  std::string where;  // "model.feb:120: Contact/contact \"c1\""
  std::string message;
  std::string hint;  // what to do about a loss

  bool is_loss() const { return kind != Kind::kNote; }
};

struct FebioOptions {
  // Name of the file in messages.
  std::string name = "model.feb";
  // SI, mm-N-s, mm-kg-s, um-nN-s or CGS, or mm-N-MPa for mm-N-s and m-N-Pa for SI. If empty: the units named by the
  // file; or mm-N-s, or where inertia or weight count the first system in which the density is that of tissue.
  std::string units;
  // Whether to split hexahedra, wedges and pyramids into tetrahedra. Neighbours match. Otherwise, hexahedra are kept in
  // models of hexahedra only, and wedges, pyramids and mixtures are refused.
  bool split_hexahedra = false;
  // Whether to import a model although the scene lacks or changes parts of it that change the answer; if not, each of
  // them is a problem.
  bool accept_loss = false;
};

struct ImportedFile {
  std::string name;
  std::string bytes;
};

// A scene, its files, and remarks on both.
struct ImportedScene {
  v1::Scene scene;
  std::vector<ImportedFile> files;
  std::vector<Notice> notices;
  std::string units;
  std::string version;
};

// Reads a FEBio model (febio_spec 4.0, 3.0 or 2.5): tetrahedra of four and ten nodes, hexahedra of eight, the materials
// of scene.proto, fixed and prescribed displacements, rigid bodies whose motion is given, nodal forces, tractions,
// pressures, constant body forces, fibres, load curves, one analysis step. Each face-connected part of the mesh becomes
// a body.
//
// All problems are added at once, each with file, line and element. Any input is safe: nothing crashes, hangs or needs
// more memory than a small multiple of the file, and no other file is read. What the scene lacks or changes is a
// problem, or with `accept_loss` listed in `notices`, in the order of the file.
//
// Source: FEBio User Manuals 2.9, 3 and 4, chapter 3; FEBio Feature Manual. Thread-safe.
std::optional<ImportedScene> ImportFebio(std::string_view bytes, const FebioOptions& options, Problems& problems);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_IMPORT_FEBIO_IMPORT_H_
