#ifndef FASCICLE_SERVER_TRANSLATE_KEPT_RESULTS_H_
#define FASCICLE_SERVER_TRANSLATE_KEPT_RESULTS_H_

#include <optional>
#include <string>
#include <vector>

#include <google/protobuf/message.h>

#include "core/base/archive.h"
#include "core/geometry/tet_mesh.h"
#include "core/geometry/voxel_grid.h"
#include "core/muscle/fibre_field.h"
#include "server/translate/result_cache.h"
#include "server/translate/translate.h"

namespace fascicle::server {

// Results of the stages that are kept. Notes tell what is noteworthy, without a path.

// Of an image's stages.
struct SegmentedImage {
  VoxelGrid grid;  // without stiffness
  std::vector<std::string> notes;

  void WriteTo(ArchiveWriter& archive) const;
  void ReadFrom(ArchiveReader& archive);
};

// Of a fibre field that is solved for, or that follows a solid.
struct ComputedFibres {
  FibreField fibres;
  std::vector<std::string> notes;

  void WriteTo(ArchiveWriter& archive) const;
  void ReadFrom(ArchiveReader& archive);
};

// What goes into the inputs of a stage: an archive whose kind is the stage, and whose version grows with each change of
// what the stage computes.

// A message. Files count by their path and digest.
void PutMessage(const char* name, const google::protobuf::Message& message, ArchiveWriter& inputs);
// Nodes and tetrahedra.
void PutMesh(const TetMesh& mesh, ArchiveWriter& inputs);

// compute() -> std::optional<Result>, or what it gave for the same inputs() -> ArchiveWriter before.
template <class Result, class Inputs, class Compute>
std::optional<Result> Kept(const TranslateTools& tools, const Inputs& inputs, const Compute& compute) {
  if (tools.results == nullptr) return compute();
  return tools.results->GetOrCompute<Result>(inputs(), tools.stop, compute);
}

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_KEPT_RESULTS_H_
