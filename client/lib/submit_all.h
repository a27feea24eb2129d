#ifndef FASCICLE_CLIENT_LIB_SUBMIT_ALL_H_
#define FASCICLE_CLIENT_LIB_SUBMIT_ALL_H_

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "client/lib/client.h"

namespace fascicle::client {

// Calls send(jobs) with batches of the jobs in their order, until all were sent or a batch failed. A batch that the
// server finds too dear to check is sent as two halves. Returns the error of the failed batch.
std::optional<Error> SendInBatches(std::span<const WantedJob> jobs,
                                   const std::function<std::optional<Error>(std::span<const WantedJob>)>& send);

// The error of a batch for users: its problems name the origin of their job and the field of its scene.
Error ErrorOfBatch(Error error, std::span<const WantedJob> jobs);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_LIB_SUBMIT_ALL_H_
