#include "client/cli/command.h"

#include <cstdio>
#include <iostream>

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>

#include "client/lib/scene_file.h"

namespace fascicle::client {
namespace {

const char* KindName(Error::Kind kind) {
  switch (kind) {
    case Error::Kind::kInvalid:
      return "invalid";
    case Error::Kind::kNoServer:
      return "no_server";
    case Error::Kind::kNotFound:
      return "not_found";
    case Error::Kind::kRefused:
      return "refused";
    case Error::Kind::kInternal:
      return "internal";
    case Error::Kind::kStopped:
      return "stopped";
  }
  return "internal";
}

Json ProblemsJson(const Problems& problems) {
  Json list = Json::array();
  for (const Problem& problem : problems.kept()) {
    Json item = {{"path", problem.path}, {"message", problem.message}};
    if (!problem.hint.empty()) item["hint"] = problem.hint;
    list.push_back(std::move(item));
  }
  return list;
}

}  // namespace

CommandError CommandError::Invalid(std::string message) {
  return CommandError(Error{Error::Kind::kInvalid, std::move(message), "", {}});
}

void Check(const std::optional<Error>& error) {
  if (error) throw CommandError(*error);
}

int ExitCodeOf(Error::Kind kind) {
  switch (kind) {
    case Error::Kind::kInvalid:
    case Error::Kind::kNotFound:
    case Error::Kind::kRefused:
      return kInvalidInput;
    case Error::Kind::kNoServer:
      return kNoServer;
    case Error::Kind::kStopped:
      return kCancelled;
    case Error::Kind::kInternal:
      return kJobFailed;
  }
  return kJobFailed;
}

void PrintError(const Error& error, bool json) {
  if (json) {
    Json object = {{"error", KindName(error.kind)}, {"message", error.message}};
    if (!error.reason.empty()) object["reason"] = error.reason;
    if (!error.problems.empty()) {
      object["problems"] = ProblemsJson(error.problems);
      object["problem_count"] = error.problems.count();
    }
    PrintJson(object);
    return;
  }
  if (error.problems.empty()) {
    std::cerr << "fascicle: " << error.message << '\n';
    return;
  }
  std::string lines = error.problems.ToString();
  if (!lines.empty() && lines.back() != '\n') lines += '\n';
  std::cerr << lines;
}

void PrintJson(const Json& value) {
  std::cout << value.dump(-1, ' ', false, Json::error_handler_t::replace) << '\n' << std::flush;
}

Client Connect(const Context& context) {
  // The default address of `fascicled`.
  constexpr const char* kDefaultServer = "127.0.0.1:7300";
  return Client(context.server.empty() ? kDefaultServer : context.server);
}

void AddSceneArgument(CLI::App& command, SceneArgument& scene) {
  command.add_option("SCENE", scene.path, "The scene file (JSON, see `fascicle schema`)")->required();
  AddSetOption(command, scene.settings);
}

void AddSetOption(CLI::App& command, std::vector<std::string>& settings) {
  command
      .add_option("--set", settings,
                  "Change the scene: a field's path, =, and its value; may be repeated. 'bodies[0].density=1000'")
      ->type_name("PATH=VALUE")
      ->allow_extra_args(false);
}

ScenePackage LoadSceneOrFail(const SceneArgument& scene) {
  const std::string& path = scene.path;
  Problems problems;
  std::optional<ScenePackage> package = LoadScene(path, problems, scene.settings);
  if (!package) {
    // Problems of the file as a whole are reported with its name.
    Error error{Error::Kind::kInvalid, "the scene " + path + " is not valid", "INVALID_SCENE", {}};
    for (const Problem& problem : problems.kept()) {
      error.problems.Add(problem.path.empty() ? path : problem.path, problem.message, problem.hint);
    }
    throw CommandError(std::move(error));
  }
  return std::move(*package);
}

CLI::App* AddCommand(CLI::App& app, const std::string& name, const std::string& description,
                     const std::string& examples) {
  CLI::App* command = app.add_subcommand(name, description);
  command->fallthrough();
  command->footer("Examples:\n" + examples);
  return command;
}

}  // namespace fascicle::client
