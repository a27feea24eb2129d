#ifndef FASCICLE_SERVER_RPC_START_STATE_H_
#define FASCICLE_SERVER_RPC_START_STATE_H_

#include "core/base/problems.h"
#include "fascicle/v1/scene.pb.h"
#include "server/store/store.h"

namespace fascicle::server {

// Copies the frame of another job in which a scene starts into an asset, and sets `start.frame.state` to it: the job
// then does not depend on the other one. Does nothing if the scene names no job, or has the state already. Adds a
// problem, with a path in the scene, if there is no such frame. Throws StoreError if the storage fails.
void StoreStartState(Store& store, v1::Scene& scene, Problems& problems);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_START_STATE_H_
