#ifndef FASCICLE_CORE_EULERIAN_CONTACT_H_
#define FASCICLE_CORE_EULERIAN_CONTACT_H_

#include <memory>
#include <span>
#include <vector>

#include "core/eulerian/body_stepper.h"
#include "core/eulerian/contact_row.h"
#include "core/eulerian/surface_samples.h"
#include "core/geometry/bounds.h"
#include "core/geometry/surface_distance.h"

namespace fascicle {

// Two bodies that may touch, or a body and a floor.
struct ContactPair {
  std::size_t a, b;  // of two bodies a < b; b may be an index of a floor
  bool floor = false;
};

// The pairs of bodies that a scene's contacts name, then all bodies with all floors. Ascending.
std::vector<ContactPair> ContactPairsOf(const Scene& scene);

// Adds a problem for each pair of bodies that touch by a contact and overlap by more than half a cell at rest. Surfaces
// must be closed; bodies without one are ignored.
void CheckOverlaps(const Scene& scene, Problems& problems);

// Contacts between bodies, found on their surfaces: pairs of points of two surfaces that face each other, nearer than a
// cell. Their velocities, normals and areas are collected in the cells of a collision grid over the world [Fan 2013,
// eq. 3.47 and section 4.5]; each such cell gives a row of the velocity program. A row acts on both bodies at the same
// points, so that what they exchange is equal and opposite. Not thread-safe; the same bits for any number of threads.
class EulerianContacts {
 public:
  // Bodies and team must outlive this.
  EulerianContacts(const Scene& scene, std::vector<const EulerianBody*> bodies, ThreadTeam& team);

  bool empty() const { return pairs_.empty(); }
  // Finds the contacts of a state for which all steppers have been prepared.
  void Find(const EulerianWorldState& state, const std::vector<BodyStepper>& steppers);
  // The longest step in which no pair of bodies moves by more than their distance, or half a cell [s].
  double LongestStep() const { return longest_step_; }
  // The rows for a step.
  //   velocities  v* of each body, for its free and prescribed nodes
  //   waves       for each body, the step allowed by its fastest wave [s]
  std::vector<ContactRow> Rows(double dt, std::span<const std::vector<Vec3>* const> velocities,
                               std::span<const double> waves) const;
  // The deepest penetration of each pair in the state of the last Find [m]; 0 where there is none.
  const std::vector<double>& depths() const { return depths_; }
  const std::vector<ContactPair>& pairs() const { return pairs_; }

 private:
  // Two points that face each other: a sample of one body, and the nearest one of the other body.
  struct Point {
    Vec3 place;   // halfway [m]
    Vec3 normal;  // of b, or that of a reversed
    double gap;   // [m]
    double area;  // that of the sample, projected on the contact; between two bodies half of it [m^2]
    std::vector<NodeWeight> of_a, of_b;  // the nodes that determine the velocities there; of a floor, none
  };
  using Points = std::vector<Point>;

  const SurfaceDistance& DistanceFrom(std::size_t body);
  void FindPair(std::size_t pair, const std::vector<BodyStepper>& steppers);
  void FindSide(std::size_t pair, bool of_a, const std::vector<BodyStepper>& steppers, Points& points);
  void FindOnFloor(std::size_t pair, const std::vector<BodyStepper>& steppers, Points& points) const;
  double CellOf(const ContactPair& pair) const;
  double DistanceOf(const ContactPair& pair) const;
  void FindLongestStep(const EulerianWorldState& state, const std::vector<BodyStepper>& steppers);
  double WeightOf(const Point& point, const ContactPair& pair, double dt,
                  std::span<const std::vector<Vec3>* const> velocities) const;
  void AddRows(std::size_t pair, double dt, double correction, std::span<const std::vector<Vec3>* const> velocities,
               std::vector<ContactRow>& rows) const;

  const std::vector<ContactPair> pairs_;
  const std::vector<Floor> floors_;
  const std::vector<const EulerianBody*> bodies_;
  ThreadTeam* const team_;
  std::vector<std::vector<SurfaceSample>> samples_;  // of each body
  std::vector<GridFrame> frames_;                    // of the state of the last Find, as all that follows
  std::vector<TriangleMesh> surfaces_;               // of each body, in the world
  std::vector<Bounds> bounds_;
  std::vector<std::unique_ptr<SurfaceDistance>> distances_;  // made when needed
  std::vector<Points> points_;                               // of each pair
  std::vector<double> depths_;
  double longest_step_ = 0;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_CONTACT_H_
