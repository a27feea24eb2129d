#ifndef FASCICLE_CLIENT_IMPORT_LOSSES_H_
#define FASCICLE_CLIENT_IMPORT_LOSSES_H_

#include <vector>

#include "client/import/febio_import.h"
#include "core/base/problems.h"

namespace fascicle::client {

// Adds each loss as a problem with what to do.
void RefuseLosses(const std::vector<Notice>& notices, Problems& problems);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_IMPORT_LOSSES_H_
