#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <vector>

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>

#include "client/cli/builtin_examples.h"
#include "client/cli/command.h"
#include "client/lib/replace_file.h"
#include "client/lib/scene_file.h"

namespace fascicle::client {
namespace {

namespace fs = std::filesystem;

constexpr const char* kExamplesExamples = R"(  fascicle examples                                   list the examples
  fascicle examples show bar_tension                  print a scene
  fascicle examples write fusiform_isometric          into fusiform_isometric.json
  fascicle examples write bar_twist mesh_file         several, with their meshes
  fascicle examples write --all --out scenes          all of them into scenes/
)";

struct ExamplesOptions {
  std::string name;                // to show
  std::vector<std::string> names;  // to write
  std::string out = ".";
  bool all = false;
  bool force = false;
};

struct Example {
  std::string name;
  std::string_view text;
  v1::Scene scene;
  std::vector<const BuiltinFile*> files;  // embedded in the program, too
  std::vector<std::string> foreign;       // not part of the project
};

const BuiltinFile* FindFile(const std::string& name) {
  for (const BuiltinFile& file : BuiltinExamples()) {
    if (file.name == name) return &file;
  }
  return nullptr;
}

void AddFile(const std::string& path, Example& example) {
  if (const BuiltinFile* file = FindFile(path)) {
    example.files.push_back(file);
  } else {
    example.foreign.push_back(path);
  }
}

std::vector<Example> AllExamples() {
  std::vector<Example> examples;
  for (const BuiltinFile& file : BuiltinExamples()) {
    if (!file.name.ends_with(".json")) continue;
    Problems problems;
    std::optional<v1::Scene> scene = ParseScene(std::string(file.content), problems);
    if (!scene) throw std::logic_error("built-in example " + std::string(file.name) + ": " + problems.ToString());
    Example example{std::string(file.name.substr(0, file.name.size() - 5)), file.content, *scene, {}, {}};
    for (const v1::Body& body : example.scene.bodies()) {
      if (body.mesh().has_file()) {
        const std::string& path = body.mesh().file().path();
        AddFile(path, example);
        if (path.ends_with(".node")) AddFile(path.substr(0, path.size() - 5) + ".ele", example);
      }
      if (body.mesh().has_surface()) AddFile(body.mesh().surface().path(), example);
      if (body.mesh().image().has_file()) AddFile(body.mesh().image().file().path(), example);
      for (const v1::FileRef& more : body.mesh().image().more_files()) AddFile(more.path(), example);
      if (body.fibres().has_file()) AddFile(body.fibres().file().path(), example);
      if (body.has_element_parameters()) AddFile(body.element_parameters().path(), example);
      if (body.has_activation_scale()) AddFile(body.activation_scale().path(), example);
      if (body.has_initial_displacement()) AddFile(body.initial_displacement().path(), example);
      if (body.fibres().bspline().has_file()) AddFile(body.fibres().bspline().file().path(), example);
    }
    examples.push_back(std::move(example));
  }
  return examples;
}

std::string FirstSentence(const std::string& text) {
  const std::size_t end = text.find(". ");
  return end == std::string::npos ? text : text.substr(0, end + 1);
}

int List(const Context& context) {
  for (const Example& example : AllExamples()) {
    if (context.json) {
      PrintJson({{"example", example.name},
                 {"title", example.scene.name()},
                 {"description", example.scene.description()},
                 {"needs", example.foreign}});
      continue;
    }
    std::printf("%-26s %s\n", example.name.c_str(), FirstSentence(example.scene.description()).c_str());
    for (const std::string& file : example.foreign) {
      std::printf("%-26s (needs the file %s beside it)\n", "", file.c_str());
    }
  }
  return kDone;
}

Example FindExample(std::string name) {
  if (name.ends_with(".json")) name.resize(name.size() - 5);
  for (Example& example : AllExamples()) {
    if (example.name == name) return std::move(example);
  }
  throw CommandError::Invalid("there is no example `" + name + "`; see `fascicle examples`");
}

void WriteFile(const std::string& name, std::string_view content, const ExamplesOptions& options,
               const Context& context) {
  const fs::path path = fs::path(options.out) / name;
  if (fs::exists(path) && !options.force) {
    throw CommandError::Invalid(path.string() + " exists already; --force overwrites it");
  }
  ReplaceFile(path, content);
  if (context.json) {
    PrintJson({{"written", path.string()}});
  } else {
    std::cout << path.string() << '\n';
  }
}

int Write(const ExamplesOptions& options, const Context& context) {
  if (options.all == !options.names.empty()) throw CommandError::Invalid("give the names of examples, or --all");
  std::vector<Example> examples;
  if (options.all) examples = AllExamples();
  for (const std::string& name : options.names) examples.push_back(FindExample(name));
  std::vector<const BuiltinFile*> written;
  for (const Example& example : examples) {
    WriteFile(example.name + ".json", example.text, options, context);
    for (const BuiltinFile* file : example.files) {
      if (std::find(written.begin(), written.end(), file) != written.end()) continue;
      written.push_back(file);
      WriteFile(std::string(file->name), file->content, options, context);
    }
    for (const std::string& file : example.foreign) {
      std::cerr << "fascicle: " << example.name << " also needs the file " << file << " beside it\n";
    }
  }
  return kDone;
}

int Show(const std::string& name) {
  std::cout << FindExample(name).text;
  return kDone;
}

}  // namespace

void AddExamples(CLI::App& app, Context& context) {
  CLI::App* command = AddCommand(app, "examples", "Example scenes: one for every feature", kExamplesExamples);
  command->callback([command, &context] {
    if (command->get_subcommands().empty()) context.action = [&context] { return List(context); };
  });
  const auto options = std::make_shared<ExamplesOptions>();
  CLI::App* list = AddCommand(*command, "list", "List the examples", kExamplesExamples);
  list->callback([&context] { context.action = [&context] { return List(context); }; });
  CLI::App* show = AddCommand(*command, "show", "Print an example", kExamplesExamples);
  show->add_option("NAME", options->name, "The example")->required();
  show->callback([options, &context] { context.action = [options] { return Show(options->name); }; });
  CLI::App* write = AddCommand(*command, "write", "Write examples as scene files", kExamplesExamples);
  write->add_option("NAME", options->names, "The examples");
  write->add_option("--out", options->out, "Folder for the files")->type_name("DIR");
  write->add_flag("--all", options->all, "All examples");
  write->add_flag("--force", options->force, "Overwrite existing files");
  write->callback([options, &context] { context.action = [options, &context] { return Write(*options, context); }; });
}

}  // namespace fascicle::client
