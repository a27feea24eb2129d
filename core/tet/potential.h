#ifndef FASCICLE_CORE_TET_POTENTIAL_H_
#define FASCICLE_CORE_TET_POTENTIAL_H_

#include "core/materials/tensor_algebra.h"
#include "core/tet/branches.h"
#include "core/tet/contact.h"
#include "core/tet/points.h"

namespace fascicle {

// The potential of a step: a function of the positions x at its end. The step finds a stationary point of
//
//   Phi(x) = sum V W(F) + sum V_n U(theta_n) + 1/2 sum m (x - c)^2 + W_v(x) + W_c(x) - f . x
//
// The terms are: elastic and active energy of points and patches; inertia and mass damping with a coefficient m and a
// centre c for each node; the viscous increment W_v = dt (mu' |dE|^2 + lambda'/2 tr(dE)^2) / dt^2, where dE is the
// change of Green strain during the step and whose derivative is the viscous stress of ViscousStress at the mean rate
// of the step; the energy of floors and rigid bodies W_c (FloorEnergy, ContactEnergy); loads f, with the second-order
// term of those that depend on positions, 1/2 (x - c) . S (x - c), see LoadExpansion. W includes Maxwell branches
// (branches.h). Quasi-static steps have neither m nor W_v.
struct IncrementalPotential {
  FibreDrive drive;
  const NodalVector* load = nullptr;         // f [N]
  const LoadExpansion* expansion = nullptr;  // of f, which is its value at the centre; null: f is constant
  std::vector<double> inertia;               // m for each node [N/m]; empty in quasi-static steps
  NodalVector inertia_centre;                // c [m]
  const NodalVector* previous = nullptr;     // positions one step ago, for W_v [m]
  double viscous_rate = 0;                   // 1/dt [1/s]; 0 without W_v
  const NodalVector* floor_start = nullptr;  // of the step, for floors whose work is exact (floor_contact.h); or null
  const ContactDrive* contact = nullptr;     // null: no rigid bodies
  // Whether UntanglingLaw replaces W, U and W_v.
  bool untangling = false;
};

// The tangent of a point's law and of its viscous increment, without pressures of patches and without untangling.
template <class Element, class Law>
class PointTangent {
 public:
  PointTangent(const IncrementalPotential& potential, const TetModel& model, const TetBody& body, const Law& law,
               std::size_t tet, int q)
      : law_(law), fibre_(FibreAt<Element>(model, tet, potential.drive, q)) {
    if (potential.drive.branches != nullptr) SetBranches(model, *potential.drive.branches, tet, q);
    if (potential.viscous_rate == 0 || !body.HasStrainDamping()) return;
    mu_ = body.damping_mu * potential.viscous_rate;
    lambda_ = body.damping_lambda * potential.viscous_rate;
    const Mat3 F = GradientAt<Element>(model, tet, ValuesOf<Element>(model, tet, *potential.previous), q);
    previous_C_ = F.transpose() * F;
  }

  // dP/dF [Pa].
  Mat9 At(const Mat3& F) const {
    Mat9 tangent = law_.Tangent(F, fibre_);
    if (branch_law_ != nullptr) {
      tangent += branch_factor_ * branch_law_->Tangent(F, {fibre_.direction, 0});
      AddRightProduct(1, branch_stress_, tangent);
    }
    if (mu_ != 0 || lambda_ != 0) {
      const Vec9 f = Flatten(F);
      const Mat3 dE = 0.5 * (F.transpose() * F - previous_C_);
      tangent += lambda_ * f * f.transpose();
      AddRightProduct(1, 2 * mu_ * dE + lambda_ * dE.trace() * Mat3::Identity(), tangent);
      AddTransposedProduct(mu_, F, tangent);
      AddLeftProduct(mu_, F * F.transpose(), tangent);
    }
    return tangent;
  }

 private:
  void SetBranches(const TetModel& model, const BranchDrive& drive, std::size_t tet, int q) {
    const Chunk& chunk = ChunkOf(model, tet);
    if (chunk.branch_point == Chunk::kElastic) return;
    branch_law_ = &std::get<std::vector<Law>>(model.groups()[chunk.group].branch_laws)[chunk.law];
    branch_factor_ = drive.factor[static_cast<std::size_t>(&chunk - model.chunks().chunks.data())];
    branch_stress_ = BranchStressAt(model, drive, tet, q);
  }

  const Law& law_;
  FibreState fibre_;
  const Law* branch_law_ = nullptr;
  double branch_factor_ = 0;
  Mat3 branch_stress_ = Mat3::Zero();
  double mu_ = 0, lambda_ = 0;  // of the viscous stress, over the step [Pa]
  Mat3 previous_C_ = Mat3::Identity();
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_POTENTIAL_H_
