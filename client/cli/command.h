#ifndef FASCICLE_CLIENT_CLI_COMMAND_H_
#define FASCICLE_CLIENT_CLI_COMMAND_H_

#include <exception>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "client/lib/client.h"

namespace CLI {  // NOLINT(readability-identifier-naming): of CLI11
class App;
}

namespace fascicle::client {

using Json = nlohmann::ordered_json;

// Exit codes of the program.
enum ExitCode { kDone = 0, kJobFailed = 1, kInvalidInput = 2, kNoServer = 3, kCancelled = 4 };

// Options common to all sub-commands, and the action to run after the command line has been parsed.
struct Context {
  std::string server;  // HOST:PORT; empty: none given
  bool json = false;   // one JSON object per line on stdout
  std::function<int()> action;
};

// Ends a sub-command with an error for users and for programs.
class CommandError : public std::exception {
 public:
  explicit CommandError(Error error) : error_(std::move(error)) {}
  // Invalid input without a field path.
  static CommandError Invalid(std::string message);
  const Error& error() const { return error_; }
  const char* what() const noexcept override { return error_.message.c_str(); }

 private:
  Error error_;
};

// The value of a call; throws CommandError if it failed.
template <class T>
T Take(Result<T> result) {
  if (!result.ok()) throw CommandError(result.error());
  return std::move(result.value());
}
void Check(const std::optional<Error>& error);

int ExitCodeOf(Error::Kind kind);

// Prints an error: each problem as `path: message (hint)` on stderr, or one object on stdout.
void PrintError(const Error& error, bool json);

// One line of JSON on stdout. Numbers that JSON cannot represent (NaN) become null.
void PrintJson(const Json& value);

// A connection to the server given by `--server`; by default to this machine's.
Client Connect(const Context& context);

// The scene file and settings given on the command line.
struct SceneArgument {
  std::string path;
  std::vector<std::string> settings;
  std::string start;  // JOB[:FRAME]: see start_frame.h
};

// Adds SCENE and --set to a sub-command. `scene` must outlive parsing.
void AddSceneArgument(CLI::App& command, SceneArgument& scene);
// Adds --set alone. `settings` must outlive parsing.
void AddSetOption(CLI::App& command, std::vector<std::string>& settings);

// Loads a scene and its files; CommandError with all problems.
ScenePackage LoadSceneOrFail(const SceneArgument& scene);

// A sub-command whose options may be mixed with the global ones.
CLI::App* AddCommand(CLI::App& app, const std::string& name, const std::string& description,
                     const std::string& examples);

// The sub-commands, each in the file of its name. They add themselves to `app` and set `context.action` when selected.
// Both must outlive parsing and the action.
void AddRun(CLI::App& app, Context& context);
void AddSubmit(CLI::App& app, Context& context);
void AddValidate(CLI::App& app, Context& context);
void AddImport(CLI::App& app, Context& context);
void AddImportJob(CLI::App& app, Context& context);
void AddWatch(CLI::App& app, Context& context);
void AddList(CLI::App& app, Context& context);
void AddShow(CLI::App& app, Context& context);
void AddInfo(CLI::App& app, Context& context);
void AddUpdate(CLI::App& app, Context& context);
void AddPause(CLI::App& app, Context& context);
void AddResume(CLI::App& app, Context& context);
void AddCancel(CLI::App& app, Context& context);
void AddRestart(CLI::App& app, Context& context);
void AddVerify(CLI::App& app, Context& context);
void AddSteer(CLI::App& app, Context& context);
void AddReplay(CLI::App& app, Context& context);
void AddLog(CLI::App& app, Context& context);
void AddDelete(CLI::App& app, Context& context);
void AddExport(CLI::App& app, Context& context);
void AddRender(CLI::App& app, Context& context);
void AddPlot(CLI::App& app, Context& context);
void AddSample(CLI::App& app, Context& context);
void AddMesh(CLI::App& app, Context& context);
void AddPhantom(CLI::App& app, Context& context);
void AddSegment(CLI::App& app, Context& context);
void AddVoxelize(CLI::App& app, Context& context);
void AddMaterials(CLI::App& app, Context& context);
void AddActivations(CLI::App& app, Context& context);
void AddMomentArms(CLI::App& app, Context& context);
void AddSchema(CLI::App& app, Context& context);
void AddExamples(CLI::App& app, Context& context);
void AddCompletion(CLI::App& app, Context& context);

// The whole command line.
int Main(int argc, char** argv);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_CLI_COMMAND_H_
