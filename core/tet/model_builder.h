#ifndef FASCICLE_CORE_TET_MODEL_BUILDER_H_
#define FASCICLE_CORE_TET_MODEL_BUILDER_H_

#include <cstdint>
#include <map>
#include <span>
#include <stop_token>
#include <utility>
#include <vector>

#include "core/base/stop.h"
#include "core/tet/model.h"

namespace fascicle {

// Fills in a TetModel from a scene, body by body. Used once, by TetModel's constructor.
//
// Bodies, nodes, elements, laws and patches are in model_builder.cc, the chunks and blocks of the elements in
// model_chunks.cc, what acts on regions (loads, supports, contact with floors) in model_regions.cc, the nodes and faces
// of quadratic hexahedra in model_hexahedra.cc, the points of surfaces in model_contact.cc.
class TetModelBuilder {
 public:
  TetModelBuilder(const Scene& scene, TetModel& model, std::stop_token stop)
      : scene_(scene), model_(model), stop_(std::move(stop)) {}

  // Throws Stopped after a stop request.
  void Build();

 private:
  // The law of an element: its kind (index in Material), then its part (0: the body's own).
  using LawKey = std::pair<std::size_t, std::int32_t>;

  void AddBody(const Body& body);
  void AddNodes(const Body& body, TetBody& entry);
  void AddNodesOfHexahedra(const TetMesh& mesh, TetBody& entry);
  std::int32_t AddMiddle(const Parents& parents, const Hexahedron& hexahedron, std::int32_t first);
  void CurveHexahedra(const TetMesh& mesh, const TetBody& entry);
  void AddElements(const Body& body, TetBody& entry);
  void AddElement(const Body& body, const TetBody& entry, std::int32_t tet);
  template <class Element>
  std::array<double, Element::kNodes> MassShares(std::size_t e, double volume) const;
  void AddGroups(const Body& body, const TetBody& entry, std::span<const LawKey> laws);
  void FillGroup(const Body& body, TetGroup& group);
  template <class Element>
  double AddPoints(std::size_t tet);
  void AddPatches(const TetGroup& group, std::span<const double> given);
  void SetSmoothing();
  void SetInverseMass();
  void SetNodeUses();
  void DropExcessCapacity();

  void SortIntoChunks(const TetMesh& mesh, const TetBody& entry, std::span<const LawKey> laws,
                      std::span<std::int32_t> sorted);
  template <class Element>
  void AddLocalNumbers(const Chunk& chunk, std::span<const std::int32_t> local_of);
  void AddBranches(Chunk& chunk);
  void SetChunks();
  template <class S>
  BlockArrays<S> MakeBlocks() const;
  void SetBlocks();

  std::vector<std::int32_t> NodesOfRegion(const Region& region, const TetBody& body) const;
  void AddNodesOfHexahedra(const Region& region, const TetBody& body, std::vector<std::int32_t>& nodes) const;
  LoadedRegion LoadedRegionIn(const Region& region, const TetBody& body) const;
  void AddVolumes(const Region& region, const TetBody& body, LoadedRegion& loaded) const;
  void AddPointVolumes(const Region& region, const TetBody& body, LoadedRegion& loaded) const;
  void AddLoads(const TetBody& body);
  PressureFace FaceOf(const Quad& side) const;
  std::vector<PressureFace> FacesOf(const Region& region, const TetBody& body) const;
  LoadedRegion::Face LoadedFace(const PressureFace& side) const;
  MeanPosition MeanOf(const Region& region, const TetBody& body) const;
  void AddPositionLoad(const Load& load, const TetBody& body);
  void AddSupports(std::int32_t body_index);
  std::map<std::int32_t, double> SurfaceAreas(const TetBody& body) const;
  void AddContactNodes(const TetBody& body);
  std::vector<PressureFace> BoundaryFaces(const TetBody& body) const;
  bool IsHeld(const SurfacePoint& point) const;
  void AddSurfacePoints(const TetBody& body);
  void AddContact();

  // The mid-edge node between nodes i and j of a quadratic element.
  std::int32_t MiddleOf(std::int32_t i, std::int32_t j) const;
  // The node of a side of a quadratic hexahedron, or of an edge, of which `corners` has each end twice.
  std::int32_t MiddleOf(Quad corners) const {
    std::sort(corners.begin(), corners.end());
    return middles_of_hexahedra_.at(corners);
  }
  void HeedStop() const { ThrowIfStopped(stop_); }

  const Scene& scene_;
  TetModel& model_;
  std::stop_token stop_;
  std::size_t activations_ = 0;                        // of the bodies so far, with those of their parts
  std::map<Quad, std::int32_t> middles_of_hexahedra_;  // of edges and sides: ascending corners
  // For each point and each element, in double precision.
  std::vector<Mat3> Dm_inverse_;
  std::vector<double> rest_volume_;
  std::vector<Vec3> fibres_;
  std::vector<std::int32_t> activation_of_;
  std::vector<double> activation_scale_;
  std::vector<std::size_t> chunk_ends_;  // in elements
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_MODEL_BUILDER_H_
