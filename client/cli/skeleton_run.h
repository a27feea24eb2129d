#ifndef FASCICLE_CLIENT_CLI_SKELETON_RUN_H_
#define FASCICLE_CLIENT_CLI_SKELETON_RUN_H_

#include <memory>
#include <stop_token>

#include "client/cli/command.h"
#include "client/cli/follow.h"
#include "client/cli/temporary_folder.h"
#include "server/embedded_server.h"

namespace fascicle::client {

// The skeleton of a scene without its bodies. CommandError if it has none.
ScenePackage SkeletonOf(const ScenePackage& package);

// Runs scenes of skeletons in a server of this process, with temporary data. Create it after StopOnInterrupt.
class SkeletonRuns {
 public:
  explicit SkeletonRuns(std::stop_token stop);
  ~SkeletonRuns();

  // Follows a run to its end. CommandError if the scene has problems, or the user has interrupted it.
  Followed Run(const ScenePackage& package);

 private:
  std::stop_token stop_;
  TemporaryFolder folder_;
  std::unique_ptr<server::EmbeddedServer> server_;
  std::unique_ptr<Client> client_;
};

// Prints the notes of a run to stderr.
void PrintNotes(const Followed& followed);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_CLI_SKELETON_RUN_H_
