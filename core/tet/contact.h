#ifndef FASCICLE_CORE_TET_CONTACT_H_
#define FASCICLE_CORE_TET_CONTACT_H_

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/scene/controls.h"
#include "core/tet/floor_contact.h"
#include "core/tet/state.h"

// Contact of bodies with rigid bodies: penalty forces on the points of their surfaces (ContactModel),
//   f = k d n,   energy k d^2 / 2,   d = -phi(x) where positive,
// with the signed distance phi of the rigid body at its present pose, and its gradient n. Without friction. In explicit
// and mixed stepping the force is k d (1 + 4 (d / a)^2), with the allowed depth a.
//
// The force of a step is exact in the sense of floor_contact.h: with the positions at the start of the step, it has the
// force f' whose mean with that at the start does the work of the energy, as far as the normal does not turn.
namespace fascicle {

// Where rigid bodies are: x = rotation X + position.
struct Placement {
  Mat3 rotation = Mat3::Identity();
  Vec3 position = Vec3::Zero();  // [m]

  Vec3 ToBody(const Vec3& x) const { return rotation.transpose() * (x - position); }
  Vec3 ToWorld(const Vec3& X) const { return rotation * X + position; }
};
using Placements = std::vector<Placement>;
// Those of all rigid bodies under the controls.
Placements PlacementsOf(const TetModel& model, const Controls& controls);

// A point that touches something, or did at the start of the step.
struct Touch {
  std::int32_t rigid = 0;  // the rigid body that it touches
  // Nodes that take weight times force.
  std::array<std::int32_t, 9> nodes = {};
  std::array<double, 9> weights = {};
  int count = 0;
  double depth = 0, allowed_depth = 0;  // [m]
  Vec3 place = Vec3::Zero();            // of the point [m]
  Vec3 normal = Vec3::Zero();           // n, away from what it touches
  Mat3 curvature = Mat3::Zero();        // dn/dx [1/m]
  FloorResponse response;
};

// What determines contact at the end of a step, apart from the positions.
struct ContactDrive {
  Placements now;
  double firmness = 1;  // factor on all stiffnesses
  // Positions that tell which faces of a point face what it touches; null: those of the end. Where a potential is
  // needed, they must not change with x.
  const NodalVector* faces = nullptr;
  // Positions at the start of the step, and the placements there, if the work is to be exact; otherwise null.
  const NodalVector* start = nullptr;
  Placements at_start;
};

// Finds what touches. Remembers how far points are from rigid bodies, so that distant ones take little time; results do
// not depend on that. The same bits for any number of threads. Not thread-safe.
class ContactSearch {
 public:
  // The model must outlive the object.
  explicit ContactSearch(const TetModel& model);

  // Everything that touches at positions x, ordered by rigid body and point. Valid until the next call.
  const std::vector<Touch>& Find(const ContactDrive& drive, const NodalVector& x, ThreadTeam& team);
  // The result of the last Find.
  const std::vector<Touch>& touches() const { return touches_; }

 private:
  // Where a point was, in the frame of a rigid body, when its distance was found last.
  struct Seen {
    Vec3 place = Vec3::Zero();
    double distance = -1;
  };
  // Touches of a rigid body with the points of [begin, end).
  void FindOnRigid(const ContactDrive& drive, const NodalVector& x, std::int32_t rigid, std::size_t begin,
                   std::size_t end, ThreadTeam& team);
  Touch TouchOnRigid(const ContactDrive& drive, const NodalVector& x, std::int32_t rigid, std::int32_t point) const;
  // Sets the response of a touch of a point; `start`: its depth at the start of the step.
  void Respond(const ContactDrive& drive, const NodalVector& x, const SurfacePoint& point, double start,
               Touch& touch) const;
  // The stiffness of the sides of a point that face a normal, at positions x [N/m].
  double StiffnessFacing(const SurfacePoint& point, const Vec3& normal, const NodalVector& x) const;
  void TakeFound(std::size_t begin, std::size_t end);

  const TetModel& model_;
  std::vector<Seen> seen_;           // rigid body after rigid body
  std::vector<std::uint8_t> found_;  // of each point: whether it touches
  std::vector<Touch> touches_, at_points_;
};

// What touches at a state, under the controls of its time.
std::vector<Touch> TouchesOf(const TetModel& model, const TetState& state, const Controls& controls, ThreadTeam& team);

// Adds the forces on nodes [N].
void AddContactForce(std::span<const Touch> touches, NodalVector& force);
// [J]; with a start, the potential of f'.
double ContactEnergy(std::span<const Touch> touches);
// The factor on an explicit step when the deepest contact, relative to the allowed depth, has hardened.
double HardenedStep(double excess);

// Largest depth relative to the allowed one.
double LargestExcess(std::span<const Touch> touches);

// All touches with a rigid body.
struct ContactSum {
  double depth = 0, excess = 0;  // deepest, at least 0 [m]; largest relative to the allowed depth
  // Force of bodies on the rigid body [N] and its moment about the origin of its frame [N m].
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
};
std::vector<ContactSum> SumsOfRigidBodies(const Placements& placements, std::span<const Touch> touches);

// The work of moving rigid bodies on bodies between two placements, by the force at one of them [J].
double WorkOfRigidBodies(std::span<const Touch> touches, const Placements& from, const Placements& to,
                         const Placements& at);

// Calls visit(row node, column node, block) for the blocks of -df/dx [N/m]: exact, or the part by curvature only.
template <class Visit>
void ForContactStiffness(std::span<const Touch> touches, bool curvature_only, const Visit& visit) {
  for (const Touch& touch : touches) {
    Mat3 block = -touch.response.force * touch.curvature;
    if (!curvature_only) block += touch.response.stiffness * touch.normal * touch.normal.transpose();
    for (int a = 0; a < touch.count; ++a) {
      for (int b = 0; b < touch.count; ++b) {
        visit(touch.nodes[a], touch.nodes[b], Mat3(touch.weights[a] * touch.weights[b] * block));
      }
    }
  }
}

// product += K p, where K contains all points, in contact or not, along every direction: an upper bound for anything
// that may come into contact before the stable step is found again.
void AddContactBound(const TetModel& model, const NodalVector& p, NodalVector& product);

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_CONTACT_H_
