#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <sstream>

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>

#include "client/cli/command.h"
#include "client/import/febio_import.h"
#include "client/lib/replace_file.h"
#include "client/lib/scene_json.h"

namespace fascicle::client {
namespace {

namespace fs = std::filesystem;

constexpr const char* kImportExamples =
    R"(  fascicle import biceps.feb --out biceps                 biceps/scene.json, its mesh and its fibres
  fascicle import biceps.feb --out biceps --units SI      lengths in m, forces in N (FEBio has no units itself)
  fascicle import knee.feb --out knee --split-hexahedra   hexahedra, wedges and pyramids become tetrahedra
  fascicle import ankle.feb --out ankle --accept-loss     without what a scene cannot have, such as springs
  fascicle run biceps/scene.json --out results

Supported: tetrahedra, neo-Hookean, isotropic elastic and Mooney-Rivlin solids, their mixtures with the fibres of muscle
and tendon material, fixed and prescribed displacements, rigid bodies whose six motions are given, nodal forces,
tractions, pressures, gravity, fibres, load curves and formulas of the first step. Whatever else changes the answer
stops the import, with its line and what to do; --accept-loss imports the rest. What changes nothing is noted.
)";

struct ImportOptions {
  std::string path;
  std::string out;
  FebioOptions febio;
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

int Import(const ImportOptions& options, const Context& context) {
  FebioOptions febio = options.febio;
  febio.name = fs::path(options.path).filename().string();
  Problems problems;
  const std::optional<ImportedScene> imported = ImportFebio(ReadModel(options.path), febio, problems);
  if (!imported) {
    throw CommandError({Error::Kind::kInvalid, options.path + " can't be imported", "INVALID_MODEL", problems});
  }
  WriteFiles(*imported, options.out);
  if (context.json) {
    PrintJson(SummaryOf(*imported, options.out));
    return kDone;
  }
  const std::string scene = (fs::path(options.out) / "scene.json").string();
  std::cout << febio.name << " (FEBio " << imported->version << ", units " << imported->units << ") imported to "
            << scene << '\n';
  PrintNotices(*imported, Notice::Kind::kNote, "notes");
  PrintNotices(*imported, Notice::Kind::kChanged, "changed");
  PrintNotices(*imported, Notice::Kind::kNotTaken, "not supported");
  return kDone;
}

}  // namespace

void AddImport(CLI::App& app, Context& context) {
  CLI::App* command =
      AddCommand(app, "import", "Convert a FEBio model (.feb, version 2.5, 3.0 or 4.0) to a scene", kImportExamples);
  const auto options = std::make_shared<ImportOptions>();
  command->add_option("MODEL", options->path, "The model file")->required()->type_name("MODEL.feb");
  command->add_option("--out", options->out, "Folder for scene.json and its files")->required()->type_name("DIR");
  command
      ->add_option(
          "--units", options->febio.units,
          "The model's units: mm-N-MPa (mm-N-s), m-N-Pa (SI), mm-kg-s, um-nN-s or CGS; by default those named by the "
          "file, or mm-N-MPa, or where inertia or weight count those in which the density is that of tissue")
      ->type_name("SYSTEM");
  command->add_flag("--split-hexahedra", options->febio.split_hexahedra,
                    "Split hexahedra, wedges and pyramids into tetrahedra");
  command->add_flag(
      "--accept-loss", options->febio.accept_loss,
      "Import a model although a scene lacks or changes parts of it that change the answer; they are listed");
  command->callback(
      [options, &context] { context.action = [options, &context] { return Import(*options, context); }; });
}

}  // namespace fascicle::client
