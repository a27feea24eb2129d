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
  fascicle import biceps.feb --out biceps --strict        fail unless the scene is complete and unchanged
  fascicle run biceps/scene.json --out results

Supported: tetrahedra, neo-Hookean, isotropic elastic and Mooney-Rivlin solids, their mixtures with the fibres of muscle
and tendon material, fixed and prescribed displacements, nodal forces, tractions, pressures, gravity, fibres and load
curves of the first step. Everything else is listed at the end.
)";

struct ImportOptions {
  std::string path;
  std::string out;
  FebioOptions febio;
  bool strict = false;
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
    case Notice::Kind::kSetting:
      return "setting";
  }
  return "";
}

// Refuses the import if the scene lacks or changes anything of the model.
void RefuseNotices(const ImportedScene& imported, const std::string& path) {
  Error error{Error::Kind::kInvalid, path + " cannot be imported unchanged", "INVALID_MODEL", {}};
  for (const Notice& notice : imported.notices) {
    if (notice.kind == Notice::Kind::kSetting) continue;
    const bool missing = notice.kind == Notice::Kind::kNotTaken;
    error.problems.Add(notice.where,
                       (missing ? "not supported" : "changed") + (notice.message.empty() ? "" : ": " + notice.message));
  }
  if (!error.problems.empty()) throw CommandError(std::move(error));
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
    notices.push_back(
        {{"kind", KindName(notice.kind)}, {"line", notice.line}, {"where", notice.where}, {"message", notice.message}});
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
  if (options.strict) RefuseNotices(*imported, options.path);
  WriteFiles(*imported, options.out);
  if (context.json) {
    PrintJson(SummaryOf(*imported, options.out));
    return kDone;
  }
  const std::string scene = (fs::path(options.out) / "scene.json").string();
  std::cout << febio.name << " (FEBio " << imported->version << ", units " << imported->units << ") imported to "
            << scene << '\n';
  PrintNotices(*imported, Notice::Kind::kSetting, "replaced by fascicle's own settings");
  PrintNotices(*imported, Notice::Kind::kChanged, "changed");
  PrintNotices(*imported, Notice::Kind::kNotTaken, "not supported");
  return kDone;
}

}  // namespace

void AddImport(CLI::App& app, Context& context) {
  CLI::App* command =
      AddCommand(app, "import", "Convert a FEBio model (.feb, version 3.0 or 4.0) to a scene", kImportExamples);
  const auto options = std::make_shared<ImportOptions>();
  command->add_option("MODEL", options->path, "The model file")->required()->type_name("MODEL.feb");
  command->add_option("--out", options->out, "Folder for scene.json and its files")->required()->type_name("DIR");
  command
      ->add_option(
          "--units", options->febio.units,
          "The model's units: mm-N-MPa (mm-N-s), m-N-Pa (SI), mm-kg-s, um-nN-s or CGS; by default those named by the "
          "file, or mm-N-MPa")
      ->type_name("SYSTEM");
  command->add_flag("--split-hexahedra", options->febio.split_hexahedra,
                    "Split hexahedra, wedges and pyramids into tetrahedra");
  command->add_flag("--strict", options->strict, "Fail, without writing, if anything is not supported or changed");
  command->callback(
      [options, &context] { context.action = [options, &context] { return Import(*options, context); }; });
}

}  // namespace fascicle::client
