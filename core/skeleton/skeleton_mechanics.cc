#include "core/skeleton/skeleton_mechanics.h"

#include <SimTKsimbody.h>

#include <algorithm>
#include <utility>

namespace fascicle {
namespace {

SimTK::Vec3 ToSimTK(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
Vec3 FromSimTK(const SimTK::Vec3& v) { return {v[0], v[1], v[2]}; }

SimTK::Transform ToSimTK(const Pose& pose) {
  const auto [w, x, y, z] = pose.quaternion;
  return {SimTK::Rotation(SimTK::Quaternion(SimTK::Vec4(w, x, y, z))), ToSimTK(pose.position)};
}

Pose FromSimTK(const SimTK::Transform& transform) {
  const SimTK::Quaternion q = transform.R().convertRotationToQuaternion();
  return {FromSimTK(transform.p()), {q[0], q[1], q[2], q[3]}};
}

// An axis of a joint, as Simbody wants it.
class AxisFunction final : public SimTK::Function {
 public:
  AxisFunction(ScalarFunction function, bool is_constant) : function_(std::move(function)), is_constant_(is_constant) {}
  double calcValue(const SimTK::Vector& x) const override { return function_.At(is_constant_ ? 0 : x[0]); }
  double calcDerivative(const SimTK::Array_<int>& components, const SimTK::Vector& x) const override {
    return is_constant_ ? 0 : function_.At(x[0], static_cast<int>(components.size()));
  }
  int getArgumentSize() const override { return is_constant_ ? 0 : 1; }
  int getMaxDerivativeOrder() const override { return 2; }
  AxisFunction* clone() const override { return new AxisFunction(*this); }

 private:
  ScalarFunction function_;
  bool is_constant_;
};

SimTK::Body::Rigid BodyOf(const Bone& bone) {
  if (bone.mass == 0) return SimTK::Body::Rigid(SimTK::MassProperties(0, SimTK::Vec3(0), SimTK::Inertia(0)));
  SimTK::Mat33 inertia;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) inertia(i, j) = bone.inertia(i, j);
  }
  const SimTK::Vec3 centre = ToSimTK(bone.mass_centre);
  const SimTK::Inertia central{SimTK::SymMat33(inertia)};
  return SimTK::Body::Rigid(SimTK::MassProperties(bone.mass, centre, central.shiftFromMassCenter(centre, bone.mass)));
}

}  // namespace

struct SkeletonMechanics::Impl {
  explicit Impl(const Skeleton& s)
      : skeleton(s), matter(system), forces(system), gravity(forces, matter, ToSimTK(s.gravity)) {
    bones.resize(s.bones.size());
    for (const Joint& joint : s.joints) AddJoint(joint);
    system.realizeTopology();
    state = system.getDefaultState();
    places.resize(s.coordinates.size());
    system.realizeModel(state);
    for (const Mobility& mobility : mobilities) {
      places[static_cast<std::size_t>(mobility.coordinate)] =
          static_cast<int>(matter.getMobilizedBody(mobility.bone).getFirstQIndex(state)) + mobility.number;
    }
  }

  SimTK::MobilizedBody& Body(int bone) {
    return bone < 0 ? static_cast<SimTK::MobilizedBody&>(matter.Ground())
                    : matter.updMobilizedBody(bones[static_cast<std::size_t>(bone)]);
  }

  void AddJoint(const Joint& joint) {
    // The coordinates of this joint, in the order of its axes.
    std::vector<int> own;
    SimTK::Array_<const SimTK::Function*> functions;
    SimTK::Array_<SimTK::Array_<int>> used;
    SimTK::Array_<SimTK::Vec3> axes;
    for (const auto* three : {&joint.rotations, &joint.translations}) {
      for (const MotionAxis& axis : *three) {
        SimTK::Array_<int> number;
        if (axis.coordinate >= 0) {
          const auto found = std::find(own.begin(), own.end(), axis.coordinate);
          number.push_back(static_cast<int>(found - own.begin()));
          if (found == own.end()) own.push_back(axis.coordinate);
        }
        functions.push_back(new AxisFunction(axis.function, axis.coordinate < 0));
        used.push_back(number);
        axes.push_back(ToSimTK(axis.axis));
      }
    }
    const auto child = static_cast<std::size_t>(joint.child);
    const SimTK::Transform in_parent = ToSimTK(joint.in_parent), in_child = ToSimTK(joint.in_child);
    const SimTK::Body::Rigid body = BodyOf(skeleton.bones[child]);
    if (own.empty()) {
      for (const SimTK::Function* function : functions) delete function;
      bones[child] = SimTK::MobilizedBody::Weld(Body(joint.parent), in_parent * Displacement(joint), body, in_child)
                         .getMobilizedBodyIndex();
      return;
    }
    bones[child] = SimTK::MobilizedBody::FunctionBased(Body(joint.parent), in_parent, body, in_child,
                                                       static_cast<int>(own.size()), functions, used, axes)
                       .getMobilizedBodyIndex();
    for (std::size_t k = 0; k < own.size(); ++k) {
      mobilities.push_back({own[k], bones[child], static_cast<int>(k)});
    }
  }

  // Of a joint without coordinates: its constant rotations and translations.
  static SimTK::Transform Displacement(const Joint& joint) {
    SimTK::Transform result;
    for (const MotionAxis& axis : joint.rotations) {
      result = result * SimTK::Transform(SimTK::Rotation(axis.function.At(0), SimTK::UnitVec3(ToSimTK(axis.axis))));
    }
    SimTK::Vec3 shift(0);
    for (const MotionAxis& axis : joint.translations) shift += axis.function.At(0) * ToSimTK(axis.axis);
    return {result.R(), shift};
  }

  SimTK::Vector Scattered(const Eigen::VectorXd& v) const {
    SimTK::Vector result(static_cast<int>(v.size()), 0.0);
    for (int k = 0; k < v.size(); ++k) result[places[static_cast<std::size_t>(k)]] = v[k];
    return result;
  }
  Eigen::VectorXd Gathered(const SimTK::Vector& v) const {
    Eigen::VectorXd result(v.size());
    for (int k = 0; k < v.size(); ++k) result[k] = v[places[static_cast<std::size_t>(k)]];
    return result;
  }

  void Realize(const Eigen::VectorXd& q, const Eigen::VectorXd* rates, SimTK::Stage stage) {
    state.updQ() = Scattered(q);
    if (rates) {
      state.updU() = Scattered(*rates);
    } else {
      state.updU() = 0;
    }
    system.realize(state, stage);
  }

  const Skeleton skeleton;
  SimTK::MultibodySystem system;
  SimTK::SimbodyMatterSubsystem matter;
  SimTK::GeneralForceSubsystem forces;
  SimTK::Force::UniformGravity gravity;
  SimTK::State state;
  std::vector<SimTK::MobilizedBodyIndex> bones;
  struct Mobility {
    int coordinate;
    SimTK::MobilizedBodyIndex bone;  // that it moves
    int number;                      // among the bone's
  };
  std::vector<Mobility> mobilities;
  std::vector<int> places;  // of each coordinate, in Simbody's vectors
};

SkeletonMechanics::SkeletonMechanics(const Skeleton& skeleton) : impl_(std::make_unique<Impl>(skeleton)) {}
SkeletonMechanics::~SkeletonMechanics() = default;

const Skeleton& SkeletonMechanics::skeleton() const { return impl_->skeleton; }

Eigen::VectorXd SkeletonMechanics::StartCoordinates() const {
  Eigen::VectorXd q(static_cast<Eigen::Index>(skeleton().coordinates.size()));
  for (Eigen::Index k = 0; k < q.size(); ++k) q[k] = skeleton().coordinates[static_cast<std::size_t>(k)].start;
  return q;
}

std::vector<Pose> SkeletonMechanics::Poses(const Eigen::VectorXd& q) {
  impl_->Realize(q, nullptr, SimTK::Stage::Position);
  std::vector<Pose> poses;
  for (std::size_t b = 0; b < impl_->bones.size(); ++b) {
    poses.push_back(FromSimTK(impl_->Body(static_cast<int>(b)).getBodyTransform(impl_->state)));
  }
  return poses;
}

std::vector<BoneMotion> SkeletonMechanics::Motions(const Eigen::VectorXd& q, const Eigen::VectorXd& rates) {
  impl_->Realize(q, &rates, SimTK::Stage::Velocity);
  std::vector<BoneMotion> motions;
  for (std::size_t b = 0; b < impl_->bones.size(); ++b) {
    const SimTK::MobilizedBody& body = impl_->Body(static_cast<int>(b));
    motions.push_back({FromSimTK(body.getBodyTransform(impl_->state)),
                       FromSimTK(body.getBodyOriginVelocity(impl_->state)),
                       FromSimTK(body.getBodyAngularVelocity(impl_->state))});
  }
  return motions;
}

Eigen::VectorXd SkeletonMechanics::GeneralizedForces(const Eigen::VectorXd& q, const std::vector<PointForce>& forces) {
  impl_->Realize(q, nullptr, SimTK::Stage::Velocity);
  SimTK::Vector_<SimTK::SpatialVec> on_bodies(impl_->matter.getNumBodies(),
                                              SimTK::SpatialVec(SimTK::Vec3(0), SimTK::Vec3(0)));
  for (const PointForce& force : forces) {
    if (force.bone < 0) continue;
    impl_->Body(force.bone).applyForceToBodyPoint(impl_->state, ToSimTK(force.place), ToSimTK(force.force), on_bodies);
    impl_->Body(force.bone).applyBodyTorque(impl_->state, ToSimTK(force.moment), on_bodies);
  }
  SimTK::Vector result;
  impl_->matter.multiplyBySystemJacobianTranspose(impl_->state, on_bodies, result);
  return impl_->Gathered(result);
}

Eigen::VectorXd SkeletonMechanics::InverseDynamics(const Eigen::VectorXd& q, const Eigen::VectorXd& rates,
                                                   const Eigen::VectorXd& accelerations) {
  impl_->Realize(q, &rates, SimTK::Stage::Dynamics);
  SimTK::Vector result;
  impl_->matter.calcResidualForceIgnoringConstraints(
      impl_->state, impl_->system.getMobilityForces(impl_->state, SimTK::Stage::Dynamics),
      impl_->system.getRigidBodyForces(impl_->state, SimTK::Stage::Dynamics), impl_->Scattered(accelerations), result);
  return impl_->Gathered(result);
}

Eigen::VectorXd SkeletonMechanics::Accelerations(const Eigen::VectorXd& q, const Eigen::VectorXd& rates,
                                                 const Eigen::VectorXd& forces) {
  impl_->Realize(q, &rates, SimTK::Stage::Dynamics);
  SimTK::Vector udot;
  SimTK::Vector_<SimTK::SpatialVec> body_accelerations;
  SimTK::Vector mobility = impl_->system.getMobilityForces(impl_->state, SimTK::Stage::Dynamics);
  mobility += impl_->Scattered(forces);
  impl_->matter.calcAccelerationIgnoringConstraints(
      impl_->state, mobility, impl_->system.getRigidBodyForces(impl_->state, SimTK::Stage::Dynamics), udot,
      body_accelerations);
  return impl_->Gathered(udot);
}

double SkeletonMechanics::Energy(const Eigen::VectorXd& q, const Eigen::VectorXd& rates) {
  impl_->Realize(q, &rates, SimTK::Stage::Dynamics);
  return impl_->system.calcEnergy(impl_->state);
}

}  // namespace fascicle
