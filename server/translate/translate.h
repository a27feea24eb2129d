#ifndef FASCICLE_SERVER_TRANSLATE_TRANSLATE_H_
#define FASCICLE_SERVER_TRANSLATE_TRANSLATE_H_

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "core/base/problems.h"
#include "core/base/profile.h"
#include "core/scene/scene.h"
#include "core/sim/frame.h"
#include "core/sim/simulation.h"
#include "fascicle/v1/frame.pb.h"
#include "fascicle/v1/job.pb.h"
#include "fascicle/v1/log.pb.h"
#include "fascicle/v1/scene.pb.h"

namespace fascicle::server {

class ResultCache;
struct RunProfile;

// The only room that knows both the wire format and the core. Stateless and thread-safe.

// The bytes of an asset by the 64 hexadecimal digits of its digest; nothing if it is missing.
using AssetReader = std::function<std::optional<std::string>(const std::string& sha256_hex)>;

// Digests of the assets that a scene refers to, without duplicates.
std::vector<std::string> AssetsOf(const v1::Scene& scene);

// Limits on the size of a scene, for all bodies together.
struct TranslateLimits {
  std::int64_t max_elements = 20'000'000;        // tetrahedra, voxels or grid cells; about 10 GB at run time
  std::int64_t max_frame_bytes = 1'000'000'000;  // a Protobuf message must stay below 2 GiB
  // Of the run, as JobSizeOf estimates them.
  std::int64_t max_memory = std::numeric_limits<std::int64_t>::max();        // [byte]
  std::int64_t max_stored_bytes = std::numeric_limits<std::int64_t>::max();  // [byte]
};

// Optional resources of a translation.
struct TranslateTools {
  Profile* profile = nullptr;      // times the stages; may be null
  ResultCache* results = nullptr;  // keeps results of long stages, without effect on the scene; may be null
  std::stop_token stop;            // ends the translation with Stopped
};

// Checks everything that can be checked without running (the proto's ranges, names, files, meshes, regions, CheckScene)
// and adds every problem with its field path ("bodies[0].density"). Null if there is any.
// Nothing large is built before its size is known to be within the limits.
std::shared_ptr<const Scene> TranslateScene(const v1::Scene& scene, const AssetReader& assets, Problems& problems,
                                            const TranslateLimits& limits = {}, const TranslateTools& tools = {});

// The tetrahedra or hexahedra of a shape.
void EncodeElements(const TetShape& shape, v1::BodyGeometry& geometry);

// Conversion to the wire format. A frame's digest and numbers are copied bit by bit.
v1::Geometry EncodeGeometry(const Scene& scene, const FrameLayout& layout);
v1::Frame EncodeFrame(const Frame& frame);
v1::Failure EncodeFailure(const Failure& failure);
v1::LogLine EncodeLine(const LogLine& line);
v1::Warnings EncodeWarnings(const std::vector<Warning>& warnings);
// The profile of the check of a scene, before the first run.
v1::Profile EncodeProfileOfCheck(const Profile& profile);
// The profile of a run, added to those of the check and of earlier runs.
v1::Profile EncodeProfile(const RunProfile& profile);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_TRANSLATE_H_
