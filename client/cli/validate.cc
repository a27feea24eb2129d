#include <iostream>
#include <memory>

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>

#include "client/cli/command.h"
#include "client/cli/start_frame.h"
#include "server/embedded_server.h"

namespace fascicle::client {
namespace {

constexpr const char* kValidateExamples =
    R"(  fascicle validate scene.json            one line per problem, exit code 2
  fascicle validate scene.json --json     the same as one object
)";

int Validate(const SceneArgument& scene, const Context& context) {
  ScenePackage package = LoadSceneOrFail(scene);
  PackStart(context, scene.start, package);
  // The server knows all rules. Without one, one is started in this process.
  std::unique_ptr<server::EmbeddedServer> own;
  if (context.server.empty()) own = server::EmbeddedServer::Start({});
  Client client(own ? own->address() : context.server);
  Check(client.Validate(package, 0));
  if (context.json) {
    PrintJson({{"scene", scene.path}, {"valid", true}});
  } else {
    std::cout << scene.path << ": valid\n";
  }
  return kDone;
}

}  // namespace

void AddValidate(CLI::App& app, Context& context) {
  CLI::App* command = AddCommand(app, "validate", "Check a scene and its files without running it", kValidateExamples);
  const auto scene = std::make_shared<SceneArgument>();
  AddSceneArgument(*command, *scene);
  AddStartOption(*command, *scene);
  command->callback([scene, &context] { context.action = [scene, &context] { return Validate(*scene, context); }; });
}

}  // namespace fascicle::client
