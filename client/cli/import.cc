#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <sstream>

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>

#include "client/cli/command.h"
#include "client/cli/input_file.h"
#include "client/import/febio_import.h"
#include "client/import/osim_import.h"
#include "client/lib/replace_file.h"
#include "client/lib/scene_json.h"
#include "core/base/letters.h"

namespace fascicle::client {
namespace {

namespace fs = std::filesystem;

constexpr const char* kImportExamples =
    R"(  fascicle import biceps.feb --out biceps                 biceps/scene.json, its mesh and its fibres
  fascicle import biceps.feb --out biceps --units SI      lengths in m, forces in N (FEBio has no units itself)
  fascicle import knee.feb --out knee --split-hexahedra   hexahedra, wedges and pyramids become tetrahedra
  fascicle import ankle.feb --out ankle --accept-loss     without what a scene cannot have, such as springs
  fascicle run biceps/scene.json --out results
  fascicle import arm26.osim --motion flexion.mot --out arm    an OpenSim model: bones, joints, muscles, their motion
  fascicle activations arm/scene.json --out arm.png            activations that exert the motion's torques

What a scene takes of FEBio: tetrahedra; neo-Hookean, isotropic elastic and Mooney-Rivlin solids, and their mixtures
with the fibres of muscle and tendon material; fixed and prescribed displacements; rigid bodies whose six motions are
given; nodal forces, tractions, pressures and gravity; fibres; load curves and formulas of the first step. Whatever else
changes the answer stops the import, with its line and what to do; --accept-loss imports the rest. What changes nothing
is noted.

What a scene takes of OpenSim (versions 3 and 4): bodies with mass and surfaces, joints with their functions,
coordinates, muscles with their points and the cylinders, spheres and ellipsoids around which they wrap. Surfaces (.vtp,
.stl, .obj) are taken from the model's folder or Geometry in it. Without bodies, the scene runs as it is.
)";

struct ImportOptions {
  std::string path;
  std::string out;
  FebioOptions febio;
  std::string motion;  // a file
  std::optional<double> low_pass;
};

std::string ReadModel(const std::string& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) throw CommandError::Invalid("there is no file " + path);
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in) throw CommandError::Invalid(path + " can't be read");
  return std::move(text).str();
}

const char* KindName(Notice::Kind kind) {
  switch (kind) {
    case Notice::Kind::kNotTaken:
      return "not_taken";
    case Notice::Kind::kChanged:
      return "changed";
    case Notice::Kind::kNote:
      return "note";
  }
  return "";
}

void WriteFiles(const ImportedScene& imported, const fs::path& folder) {
  const std::string scene = JsonText(imported.scene);
  if (scene.size() > kMaxSceneBytes) {
    throw CommandError::Invalid("the scene would be larger than 16 MiB: the model has too many loads and curves");
  }
  for (const ImportedFile& file : imported.files) ReplaceFile(folder / file.name, file.bytes);
  ReplaceFile(folder / "scene.json", scene);
}

void PrintNotices(const ImportedScene& imported, Notice::Kind kind, const char* title) {
  bool any = false;
  for (const Notice& notice : imported.notices) {
    if (notice.kind != kind) continue;
    if (!std::exchange(any, true)) std::cout << title << ":\n";
    std::cout << "  " << notice.where << (notice.message.empty() ? "" : ": " + notice.message) << '\n';
  }
}

Json SummaryOf(const ImportedScene& imported, const fs::path& folder) {
  Json files = Json::array(), notices = Json::array();
  for (const ImportedFile& file : imported.files) files.push_back((folder / file.name).string());
  for (const Notice& notice : imported.notices) {
    notices.push_back({{"kind", KindName(notice.kind)},
                       {"line", notice.line},
                       {"where", notice.where},
                       {"message", notice.message},
                       {"hint", notice.hint}});
  }
  return {{"scene", (folder / "scene.json").string()},
          {"files", std::move(files)},
          {"version", imported.version},
          {"units", imported.units},
          {"notices", std::move(notices)}};
}

bool IsOsim(const ImportOptions& options) { return LowerExtension(options.path) == ".osim"; }

// A surface of a bone, beside the model or in its folder Geometry. Only the last part of its path counts, so that no
// other files are read.
std::optional<std::string> ReadSurfaceFile(const fs::path& model, const std::string& file) {
  const std::string name = file.substr(file.find_last_of("/\\") + 1);
  for (const fs::path& path : {model.parent_path() / "Geometry" / name, model.parent_path() / name}) {
    std::error_code error;
    if (!fs::is_regular_file(path, error)) continue;
    Problems unreadable;
    return ReadInputFile(path.string(), unreadable);
  }
  return std::nullopt;
}

std::optional<ImportedScene> ImportModel(const ImportOptions& options, Problems& problems) {
  const std::string name = fs::path(options.path).filename().string();
  if (!IsOsim(options)) {
    if (!options.motion.empty()) problems.Add("--motion", "belongs to OpenSim models", "give a .osim file");
    if (options.low_pass) problems.Add("--low-pass", "belongs to motions of OpenSim models", "omit it");
    FebioOptions febio = options.febio;
    febio.name = name;
    return ImportFebio(ReadModel(options.path), febio, problems);
  }
  OsimOptions osim;
  osim.name = name;
  osim.accept_loss = options.febio.accept_loss;
  osim.low_pass = options.low_pass.value_or(osim.low_pass);
  osim.surface = [&](const std::string& file) { return ReadSurfaceFile(options.path, file); };
  if (options.low_pass && options.motion.empty()) {
    problems.Add("--low-pass", "applies to a motion", "give --motion, or omit it");
  }
  if (!options.motion.empty()) {
    osim.motion = ImportedFile{fs::path(options.motion).filename().string(), ReadModel(options.motion)};
  }
  return ImportOsim(ReadModel(options.path), osim, problems);
}

int Import(const ImportOptions& options, const Context& context) {
  Problems problems;
  const std::optional<ImportedScene> imported = ImportModel(options, problems);
  if (!imported || !problems.empty()) {
    throw CommandError({Error::Kind::kInvalid, options.path + " can't be imported", "INVALID_MODEL", problems});
  }
  WriteFiles(*imported, options.out);
  if (context.json) {
    PrintJson(SummaryOf(*imported, options.out));
    return kDone;
  }
  const std::string scene = (fs::path(options.out) / "scene.json").string();
  std::cout << fs::path(options.path).filename().string() << " (" << (IsOsim(options) ? "" : "FEBio ")
            << imported->version << ", units " << imported->units << ") imported to " << scene << '\n';
  PrintNotices(*imported, Notice::Kind::kNote, "notes");
  PrintNotices(*imported, Notice::Kind::kChanged, "changed");
  PrintNotices(*imported, Notice::Kind::kNotTaken, "not supported");
  return kDone;
}

}  // namespace

void AddImport(CLI::App& app, Context& context) {
  CLI::App* command =
      AddCommand(app, "import", "Convert a FEBio (.feb) or an OpenSim (.osim) model to a scene", kImportExamples);
  const auto options = std::make_shared<ImportOptions>();
  command->add_option("MODEL", options->path, "The model file")->required()->type_name("MODEL.feb|MODEL.osim");
  command->add_option("--out", options->out, "Folder for scene.json and its files")->required()->type_name("DIR");
  command
      ->add_option(
          "--units", options->febio.units,
          "The model's units: mm-N-MPa (mm-N-s), m-N-Pa (SI), mm-kg-s, um-nN-s or CGS; by default those named by the "
          "file, or mm-N-MPa, or where inertia or weight count those in which the density is that of tissue")
      ->type_name("SYSTEM");
  command->add_option("--motion", options->motion, "The motion of an OpenSim model: a table of its coordinates")
      ->type_name("FILE.mot|FILE.sto");
  command
      ->add_option("--low-pass", options->low_pass,
                   "What is faster is removed from the motion as noise [Hz]; 6 by default, 0: nothing")
      ->check(CLI::Range(0.0, 1e6))
      ->type_name("HZ");
  command->add_flag("--split-hexahedra", options->febio.split_hexahedra,
                    "Split hexahedra, wedges and pyramids into tetrahedra");
  command->add_flag(
      "--accept-loss", options->febio.accept_loss,
      "Import a model although a scene lacks or changes parts of it that change the answer; they are listed");
  command->callback(
      [options, &context] { context.action = [options, &context] { return Import(*options, context); }; });
}

}  // namespace fascicle::client
