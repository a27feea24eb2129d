#include "client/import/losses.h"

#include <string>

namespace fascicle::client {

void RefuseLosses(const std::vector<Notice>& notices, Problems& problems) {
  for (const Notice& notice : notices) {
    if (!notice.is_loss()) continue;
    const bool missing = notice.kind == Notice::Kind::kNotTaken;
    problems.Add(notice.where,
                 (missing ? "not supported" : "changed") + (notice.message.empty() ? "" : ": " + notice.message),
                 (notice.hint.empty() ? "" : notice.hint + ", or ") + "import without it by --accept-loss");
  }
}

}  // namespace fascicle::client
