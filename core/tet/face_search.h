#ifndef FASCICLE_CORE_TET_FACE_SEARCH_H_
#define FASCICLE_CORE_TET_FACE_SEARCH_H_

#include <memory>
#include <optional>
#include <vector>

#include "core/geometry/triangle_tree.h"
#include "core/tet/model.h"

namespace fascicle {

// The place of a deformed surface that is nearest to a point.
struct NearestFace {
  std::int32_t face = 0;               // of TouchingSurface::faces
  std::array<double, 9> weights = {};  // of the face's nodes there
  double distance = 0;                 // signed, negative inside of the body [m]
  Vec3 normal = Vec3::Zero();          // its gradient with respect to the point
  Mat3 curvature = Mat3::Zero();       // that of the normal, of edges and corners; faces count as flat [1/m]
};

// Finds the nearest places of one surface to the points of another one, both deformed. Only those nearer than reach()
// are found. Candidates are kept while nodes move little; results do not depend on that. Not thread-safe, except for
// Find.
class FaceSearch {
 public:
  // The model must outlive the object.
  FaceSearch(const TetModel& model, const ContactPass& pass);

  double reach() const { return reach_; }

  // Call before the functions below, whenever positions have changed.
  void Update(const NodalVector& x, ThreadTeam& team);

  // The place nearest to a point of the pass, if it is within reach.
  std::optional<NearestFace> Find(const NodalVector& x, std::size_t point) const;

  // Calls visit(face) for the faces whose distance from a point may be below `distance`, at most reach(), ascending.
  template <class Visit>
  void ForFacesNear(const NodalVector& x, std::size_t point, double distance, const Visit& visit) const {
    const Vec3 at = from_.points[point].PositionIn(x);
    for (std::int32_t k = begin_[point]; k < begin_[point + 1]; ++k) {
      if (LeastDistance(x, candidates_[k], at) > distance) continue;
      if (PlaceOn(x, candidates_[k], at).squared <= distance * distance) visit(candidates_[k]);
    }
  }

 private:
  // The nearest place of one face.
  struct Place {
    std::array<double, 9> weights = {};
    Vec3 point = Vec3::Zero(), normal = Vec3::Zero();  // normal: of the face, unit
    Vec3 edge = Vec3::Zero();                   // direction of the edge on which it is; zero inside and at corners
    bool is_inside = false, is_corner = false;  // whether it is neither on an edge nor at a corner
    double squared = 0;                         // distance [m^2]
  };
  double LeastDistance(const NodalVector& x, std::int32_t face, const Vec3& at) const;
  Place PlaceOn(const NodalVector& x, std::int32_t face, const Vec3& at) const;
  bool HasMoved(const NodalVector& x) const;

  const TetModel& model_;
  const TouchingSurface &from_, &onto_;
  double reach_, margin_;
  NodalVector reference_;  // positions for which candidates were found
  std::vector<std::int32_t> begin_, candidates_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_FACE_SEARCH_H_
