#ifndef FASCICLE_CLIENT_CLI_CONVERGENCE_H_
#define FASCICLE_CLIENT_CLI_CONVERGENCE_H_

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/cli/command.h"
#include "client/cli/follow.h"
#include "client/lib/series_table.h"
#include "fascicle/v1/scene.pb.h"

namespace fascicle::client {

// `run --check`: how much a scene's answer changes with half the time step, and with half the mesh size.

// The scene with half its time step. Where the scene leaves the step to the method: half the fraction of the stable
// step, half the frame interval, or half the mean step of the run, which made `steps` of them. Nothing if the scene has
// no time steps.
std::optional<v1::Scene> WithHalfStep(const v1::Scene& scene, std::int64_t steps);
// The scene with every edge of its meshes, or its grid's cells, halved once more. Nothing if it is refined already as
// often as possible, or starts as a frame, which belongs to its mesh.
std::optional<v1::Scene> WithHalfMeshSize(const v1::Scene& scene);

// The change of a series between two runs of one scene.
struct SeriesChange {
  std::string name, unit;
  double before = 0, after = 0;  // final values
  // The largest change in a frame, relative to the largest absolute value of the components of this quantity. Values
  // below a millionth of others with their dimension count as zero.
  double relative = 0;
};

// The changes of all series but poses and those of the solver. Both tables must have the same columns; frames that only
// one of them has are ignored.
std::vector<SeriesChange> ChangesBetween(const SeriesTable& before, const SeriesTable& after);

// One further run of a check.
struct CheckedRun {
  std::string what;                   // "half the time step"
  v1::Job job;                        // final
  std::vector<SeriesChange> changes;  // empty if it has no frames
};

// A table of the changes of each run, the largest change, and advice where it is above 1 %.
void PrintCheck(const std::vector<CheckedRun>& runs);
Json CheckJson(const std::vector<CheckedRun>& runs);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_CLI_CONVERGENCE_H_
