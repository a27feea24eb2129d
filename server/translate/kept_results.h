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

// Results of stages that are kept. Notes are remarks without paths.

// Result of an image's stages.
struct SegmentedImage {
  VoxelGrid grid;  // without stiffness
  std::vector<std::string> notes;

  void WriteTo(ArchiveWriter& archive) const;
  void ReadFrom(ArchiveReader& archive);
};

// Result of harmonic or B-spline fibres.
struct ComputedFibres {
  FibreField fibres;
  std::vector<std::string> notes;

  void WriteTo(ArchiveWriter& archive) const;
  void ReadFrom(ArchiveReader& archive);
};

// The inputs of a stage: an archive whose kind is the stage, and whose version increases with each change of the
// stage's results.

// A message. Files are identified by path and digest.
void PutMessage(const char* name, const google::protobuf::Message& message, ArchiveWriter& inputs);
// Nodes and tetrahedra.
void PutMesh(const TetMesh& mesh, ArchiveWriter& inputs);

// Returns the result of compute() -> std::optional<Result>, or the kept one for the same inputs() -> ArchiveWriter.
template <class Result, class Inputs, class Compute>
std::optional<Result> Kept(const TranslateTools& tools, const Inputs& inputs, const Compute& compute) {
  if (tools.results == nullptr) return compute();
  return tools.results->GetOrCompute<Result>(inputs(), tools.stop, compute);
}

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_KEPT_RESULTS_H_
