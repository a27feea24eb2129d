#include "core/sim/fingerprint.h"

#include <span>
#include <type_traits>

namespace fascicle {
namespace {

// Feeds a scene to a digest, field by field.
class Fingerprint {
 public:
  Digest Of(const Scene& scene) {
    Put(scene.duration);
    PutItems(scene.gravity.acceleration);
    Put(scene.gravity.scale);
    Put(scene.floors.size());
    for (const Floor& floor : scene.floors) {
      Put(floor.name);
      PutItems(floor.point);
      PutItems(floor.normal);
    }
    Put(static_cast<int>(scene.tet.stepping));
    Put(scene.tet.time_step.value_or(0.0));
    Put(scene.tet.safety);
    Put(scene.tet.solver_tolerance);
    Put(static_cast<int>(scene.tet.element));
    Put(static_cast<int>(scene.tet.volume));
    Put(static_cast<int>(scene.tet.precision));
    Put(scene.tet.newton_tolerance);
    Put(static_cast<int>(scene.tet.linear_solver));
    Put(static_cast<int>(scene.method));
    Put(static_cast<int>(scene.voxel.stepping));
    Put(scene.voxel.mean_dilatation);
    Put(scene.voxel.time_step.value_or(0.0));
    Put(scene.voxel.tolerance);
    Put(scene.voxel.start_loaded);
    Put(scene.eulerian);
    Put(scene.squeezes.size());
    for (const Squeeze& squeeze : scene.squeezes) {
      PutItems(squeeze.point);
      PutItems(squeeze.normal);
      Put(squeeze.force_density);
      Put(squeeze.width);
      Put(squeeze.scale);
    }
    Put(scene.bodies.size());
    for (const Body& body : scene.bodies) Put(body);
    Put(scene.output);
    return sha_.Finish();
  }

 private:
  template <class Value>
  requires std::is_arithmetic_v<Value>
  void Put(const Value& value) { sha_.Update(std::as_bytes(std::span(&value, 1))); }

  void Put(const std::string& text) {
    Put(text.size());
    sha_.Update(text);
  }

  template <class Items>
  void PutItems(const Items& items) {
    Put(static_cast<std::size_t>(items.size()));
    sha_.Update(std::as_bytes(std::span(items.data(), static_cast<std::size_t>(items.size()))));
  }

  void Put(const Curve& curve) {
    PutItems(curve.times);
    PutItems(curve.values);
    Put(static_cast<int>(curve.interpolation));
  }

  void Put(const std::optional<Curve>& curve) {
    Put(curve.has_value());
    if (curve) Put(*curve);
  }

  void Put(const Motion& motion) {
    for (const auto& translation : motion.translation) Put(translation);
    Put(motion.rotation.has_value());
    if (!motion.rotation) return;
    PutItems(motion.rotation->point);
    PutItems(motion.rotation->axis);
    Put(motion.rotation->angle);
  }

  void Put(const EulerianMethod& method) {
    Put(method.cell_size);
    Put(method.margin);
    Put(method.room.has_value());
    if (method.room) {
      PutItems(method.room->lowest);
      PutItems(method.room->highest);
    }
    Put(static_cast<int>(method.volume));
    Put(method.stabilization);
    Put(method.implicit_elasticity);
    Put(method.time_step.value_or(0.0));
    Put(method.maccormack);
  }

  void Put(const Selector& selector) {
    Put(selector.index());
    if (const auto* tag = std::get_if<TagSelector>(&selector)) Put(tag->tag);
    if (const auto* plane = std::get_if<PlaneSelector>(&selector)) PutItems(plane->point), PutItems(plane->normal);
    if (const auto* box = std::get_if<BoxSelector>(&selector)) PutItems(box->min), PutItems(box->max);
    if (const auto* sphere = std::get_if<SphereSelector>(&selector)) PutItems(sphere->center), Put(sphere->radius);
    if (const auto* side = std::get_if<SideSelector>(&selector)) {
      PutItems(side->direction);
      Put(side->max_angle);
      Put(side->depth);
    }
  }

  // A law holds nothing but numbers, which follow from its parameters.
  void Put(const Material& material) {
    Put(material.index());
    std::visit(
        [this]<class Law>(const Law& law) {
          static_assert(std::is_trivially_copyable_v<Law> && sizeof(Law) % sizeof(double) == 0);
          sha_.Update(std::as_bytes(std::span(&law, 1)));
        },
        material);
  }

  void Put(const Body& body) {
    Put(body.name);
    PutItems(body.mesh.nodes);
    PutItems(body.mesh.tetrahedra);
    Put(body.mesh.curved_edges.size());
    for (const CurvedEdge& edge : body.mesh.curved_edges) {
      PutItems(edge.ends);
      PutItems(edge.middle);
    }
    PutItems(body.bricks.nodes);
    PutItems(body.bricks.bricks);
    PutItems(body.bricks.grid.direction);
    PutItems(body.bricks.grid.stiffness);
    PutItems(body.surface.nodes);
    PutItems(body.surface.triangles);
    Put(body.plasticity.has_value());
    if (body.plasticity) {
      Put(body.plasticity->yield_stress);
      Put(body.plasticity->relaxation_time);
    }
    Put(body.density);
    Put(body.material);
    Put(body.more_materials.size());
    for (const Material& material : body.more_materials) Put(material);
    PutItems(body.material_of);
    PutItems(body.fibres);
    Put(body.regions.size());
    for (const Region& region : body.regions) {
      Put(region.name);
      PutItems(region.nodes);
      PutItems(region.triangles);
      PutItems(region.quads);
      Put(region.selectors.size());
      for (const Selector& selector : region.selectors) Put(selector);
    }
    Put(body.constraints.size());
    for (const Constraint& constraint : body.constraints) {
      Put(constraint.region);
      PutItems(constraint.axes);
      Put(constraint.motion);
    }
    Put(body.loads.size());
    for (const Load& load : body.loads) {
      Put(load.region);
      Put(load.kind.index());
      std::visit([this](const auto& kind) { PutItems(VectorOf(kind)); }, load.kind);
      Put(load.scale);
      Put(load.kept);
    }
    Put(body.activation);
    Put(body.more_activations.size());
    for (const Curve& activation : body.more_activations) Put(activation);
    PutItems(body.activation_of);
    PutItems(body.activation_scale);
    PutItems(body.initial_displacement);
    Put(body.damping.mass_proportional);
    Put(body.damping.stiffness_proportional);
    Put(body.damping.viscosity);
  }

  static const Vec3& VectorOf(const Traction& traction) { return traction.vector; }
  static const Vec3& VectorOf(const NodalForce& force) { return force.total; }

  void Put(const Output& output) {
    Put(output.frame_interval);
    Put(output.fields.size());
    for (const OutputField field : output.fields) Put(static_cast<int>(field));
    Put(output.probes.size());
    for (const Probe& probe : output.probes) {
      Put(probe.name);
      Put(probe.body);
      Put(probe.node);
    }
    Put(output.settle_speed.value_or(0.0));
  }

  Sha256 sha_;
};

}  // namespace

Digest FingerprintOf(const Scene& scene) { return Fingerprint().Of(scene); }

}  // namespace fascicle
