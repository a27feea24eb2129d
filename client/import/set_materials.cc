// Laws, density, activation and fibres of a body.
#include <Eigen/Geometry>
#include <algorithm>
#include <charconv>
#include <cstdio>

#include "client/import/body_draft.h"
#include "core/geometry/text_scanner.h"

namespace fascicle::client {
namespace {

const ImportedMaterial& MaterialOf(const Model& model, std::int32_t part) {
  return model.materials[static_cast<std::size_t>(model.mesh.parts[static_cast<std::size_t>(part)].material)];
}

// Inertia and weight need the density; equilibrium does not.
void SetDensity(const Model& model, XmlSource& source, BodyDraft& draft) {
  const bool counts = model.control.dynamic || !model.body_forces.empty();
  const ImportedMaterial& first = MaterialOf(model, draft.mesh.parts[0]);
  if (!counts && first.density > kMaxSceneDensity) return;  // the density is not used
  if (first.density > 0) draft.body.set_density(first.density);
  if (!counts) return;
  if (first.density == 0) {
    source.Fail(first.node, "has no density", "inertia and weight need one: give <density>");
  } else if (first.density > kMaxSceneDensity) {
    char text[128];
    std::snprintf(text, sizeof(text), "its density is %.3g kg/m^3 in the units %s", first.density,
                  model.units.name.c_str());
    source.Fail(first.node.child("density"), text, "correct it, or give other units with --units");
  }
  for (const std::int32_t p : draft.mesh.parts) {
    const ImportedMaterial& other = MaterialOf(model, p);
    if (other.density == first.density) continue;
    source.Remark(Notice::Kind::kChanged, other.node, "has the density of " + Quoted(first.name) + ": a body has one",
                  "give both materials the same density");
  }
}

bool SameDrive(const Driven& a, const Driven& b) { return a.value == b.value && a.controller == b.controller; }

void SetActivation(const Model& model, CurveMaker& curves, Origins& origins, BodyDraft& draft) {
  const Driven* first = nullptr;
  for (const std::int32_t p : draft.mesh.parts) {
    const ImportedMaterial& material = MaterialOf(model, p);
    if (!material.activation || (first != nullptr && SameDrive(*first, *material.activation))) continue;
    const Driven& driven = *material.activation;
    const auto curve = curves.MakeActivation(driven.value, driven.controller, driven.node);
    if (!curve) continue;
    if (first == nullptr) {
      first = &driven;
      *draft.body.mutable_activation() = *curve;
      origins[draft.path + ".activation"] = driven.node;
      continue;
    }
    v1::RegionActivation& part = *draft.body.add_region_activations();
    part.set_region(draft.PartRegion(p, model.mesh.parts[static_cast<std::size_t>(p)].name));
    *part.mutable_curve() = *curve;
  }
}

// The shortest rotation that takes x to the direction from the centre or axis to a point; none on it, and none where
// the direction is -x, as in FEBio.
Mat3 TurnToPoint(const Round& round, const Vec3& point) {
  Vec3 direction = point - round.centre;
  if (round.axis) direction -= round.axis->dot(direction) * *round.axis;
  direction = direction.stableNormalized();
  if (!(direction.norm() > 0.5) || Vec3::UnitX().cross(direction).norm() < 1e-12) return Mat3::Identity();
  return Eigen::Quaterniond::FromTwoVectors(Vec3::UnitX(), direction).toRotationMatrix();
}

// Axes whose first one is the turned vector; the third is perpendicular to it and to the turned y.
Mat3 RoundFrame(const Axes& axes, const Vec3& place, XmlSource& source, bool& good) {
  const Mat3 turn = TurnToPoint(*axes.round, place);
  Mat3 frame;
  frame.col(0) = turn * axes.round->vector;
  const Vec3 across = frame.col(0).cross(turn.col(1));
  if (!(across.norm() > 1e-3)) {
    if (good) source.Fail(axes.node, "has a vector along y, which leaves its other axes open", "give another vector");
    good = false;
    return Mat3::Identity();
  }
  frame.col(2) = across.normalized();
  frame.col(1) = frame.col(2).cross(frame.col(0));
  return frame;
}

// The frame of a material or of element data at an element, of which `place` is a point.
Mat3 FrameOf(const Axes& axes, const Mesh& mesh, const Part& part, std::size_t e, const Vec3& place, XmlSource& source,
             bool& good) {
  if (axes.round) return RoundFrame(axes, place, source, good);
  if (!axes.local) return axes.given;
  const std::size_t count = part.count;
  std::array<Vec3, 3> x;
  for (int k = 0; k < 3; ++k) {
    const auto n = static_cast<std::size_t>((*axes.local)[k]);
    if (n >= count) {
      if (good) source.Fail(axes.node, "refers to more nodes than the elements of " + Quoted(part.name) + " have");
      good = false;
      return Mat3::Identity();
    }
    x[k] = mesh.nodes[static_cast<std::size_t>(part.nodes[e * count + n])];
  }
  Mat3 frame;
  frame.col(0) = (x[1] - x[0]).stableNormalized();
  frame.col(2) = frame.col(0).cross((x[2] - x[0]).stableNormalized()).stableNormalized();
  frame.col(1) = frame.col(2).cross(frame.col(0));
  return frame;
}

// The fibres of one part, element by element.
class FibreMaker {
 public:
  FibreMaker(const Model& model, XmlSource& source) : model_(model), source_(source) {}

  // The fibre at the point `place` of an element.
  Vec3 Fibre(std::int32_t p, std::size_t e, const Vec3& place) {
    const Part& part = model_.mesh.parts[static_cast<std::size_t>(p)];
    const ImportedMaterial& material = MaterialOf(model_, p);
    if (!material.needs_fibres) return Vec3::UnitX();
    const std::int64_t id = part.ids[e];
    if (const auto own = model_.data.fibres.find(id); own != model_.data.fibres.end()) {
      // Such data rotate the first material axis to the fibre.
      if (material.fibre.kind == FibreSource::Kind::kVector && material.fibre.vector == Vec3::UnitX()) {
        return own->second;
      }
      return Refuse(material.fibre.node, "has both its own fibres and fibres in element data", "keep one of them");
    }
    Mat3 frame = Mat3::Identity();
    if (const auto own = model_.data.axes.find(id); own != model_.data.axes.end()) frame = own->second;
    for (const Axes& axes : material.axes) frame *= FrameOf(axes, model_.mesh, part, e, place, source_, good_);
    return frame * InAxes(material, part, e, id, place);
  }

 private:
  Vec3 Refuse(pugi::xml_node node, const std::string& message, const std::string& hint) {
    if (good_) source_.Fail(node, message, hint);
    good_ = false;
    return Vec3::UnitX();
  }

  Vec3 InAxes(const ImportedMaterial& material, const Part& part, std::size_t e, std::int64_t id, const Vec3& place) {
    const FibreSource& fibre = material.fibre;
    if (fibre.kind == FibreSource::Kind::kVector) return fibre.vector;
    if (fibre.kind == FibreSource::Kind::kRound) return TurnToPoint(fibre.round, place) * fibre.round.vector;
    if (fibre.kind == FibreSource::Kind::kMap) {
      const auto map = model_.data.maps.find(fibre.map);
      if (map == model_.data.maps.end()) {
        return Refuse(fibre.node, "there are no element data " + Quoted(fibre.map) + " of data_type vec3", "");
      }
      const auto own = map->second.find(id);
      if (own != map->second.end()) return own->second;
      return Refuse(fibre.node,
                    "the element data " + Quoted(fibre.map) + " have nothing for element " + std::to_string(id), "");
    }
    const std::size_t count = part.count;
    const auto a = static_cast<std::size_t>(fibre.local[0]), b = static_cast<std::size_t>(fibre.local[1]);
    if (a >= count || b >= count) {
      return Refuse(fibre.node, "refers to more nodes than the elements of " + Quoted(part.name) + " have", "");
    }
    return (model_.mesh.nodes[static_cast<std::size_t>(part.nodes[e * count + b])] -
            model_.mesh.nodes[static_cast<std::size_t>(part.nodes[e * count + a])])
        .stableNormalized();
  }

  const Model& model_;
  XmlSource& source_;
  bool good_ = true;
};

void AppendNumber(double number, char end, std::string& text) {
  char buffer[32];
  text.append(buffer, std::to_chars(buffer, buffer + sizeof(buffer), number).ptr);
  text += end;
}

}  // namespace

// Models often put the stress into the load curve, and smooth curves overshoot. Both laws are linear in the product of
// stress and activation; the passive stress of muscle is relative to its peak stress, too.
void ScaleActivations(Model& model, CurveMaker& curves) {
  for (ImportedMaterial& material : model.materials) {
    if (!material.activation) continue;
    const double largest = curves.Largest(*material.activation);
    if (!(largest > 1)) continue;
    material.activation->value /= largest;
    if (material.law.has_muscle()) {
      v1::Muscle& law = *material.law.mutable_muscle();
      law.set_peak_stress(largest * law.peak_stress());
      law.set_passive_scale(law.passive_scale() / largest);
    } else if (material.law.has_trans_iso_mooney_rivlin()) {
      v1::TransIsoMooneyRivlin& law = *material.law.mutable_trans_iso_mooney_rivlin();
      law.set_active_stress(largest * law.active_stress());
    }
  }
}

void SetMaterials(const Model& model, XmlSource& source, CurveMaker& curves, Origins& origins, BodyDraft& draft) {
  const std::int32_t first = draft.mesh.parts[0];
  *draft.body.mutable_material() = MaterialOf(model, first).law;
  origins[draft.path + ".material"] = MaterialOf(model, first).node;
  for (const std::int32_t p : draft.mesh.parts) {
    const Part& part = model.mesh.parts[static_cast<std::size_t>(p)];
    if (part.material == model.mesh.parts[static_cast<std::size_t>(first)].material) continue;
    origins[draft.path + "." + IndexPath("region_materials", std::size_t(draft.body.region_materials_size()))] =
        MaterialOf(model, p).node;
    v1::RegionMaterial& other = *draft.body.add_region_materials();
    other.set_region(draft.PartRegion(p, part.name));
    *other.mutable_material() = MaterialOf(model, p).law;
  }
  SetDensity(model, source, draft);
  SetActivation(model, curves, origins, draft);
}

void SetFibres(const Model& model, const Tetrahedra& all, XmlSource& source, BodyDraft& draft,
               std::vector<ImportedFile>& files) {
  const auto needs = [&](std::int32_t p) { return MaterialOf(model, p).needs_fibres; };
  if (std::none_of(draft.mesh.parts.begin(), draft.mesh.parts.end(), needs)) return;
  FibreMaker maker(model, source);
  std::vector<Vec3> fibres;
  fibres.reserve(draft.mesh.tetrahedra.size());
  bool same = true;
  const auto mean_of = [&](const auto& nodes) {
    Vec3 sum = Vec3::Zero();
    for (const std::int32_t n : nodes) {
      sum += 1.0 / static_cast<double>(nodes.size()) * model.mesh.nodes[static_cast<std::size_t>(n)];
    }
    return sum;
  };
  for (std::size_t i = 0; i < draft.mesh.tetrahedra.size(); i += all.step()) {
    const std::size_t t = draft.mesh.tetrahedra[i];
    const Vec3 centroid = all.of_hexahedra ? mean_of(HexahedronOf(model.mesh, all, t)) : mean_of(all.corners[t]);
    fibres.push_back(maker.Fibre(all.part[t], static_cast<std::size_t>(all.element[t]), centroid));
    same = same && fibres.back() == fibres.front();
  }
  if (same) {
    for (const double component : fibres.front()) {
      draft.body.mutable_fibres()->mutable_constant()->add_direction(component);
    }
    return;
  }
  ImportedFile file{draft.body.name() + "_fibres.txt", "# the fibre of each element, in the order of the mesh\n"};
  for (const Vec3& fibre : fibres) {
    AppendNumber(fibre[0], ' ', file.bytes);
    AppendNumber(fibre[1], ' ', file.bytes);
    AppendNumber(fibre[2], '\n', file.bytes);
  }
  draft.body.mutable_fibres()->mutable_file()->set_path(file.name);
  files.push_back(std::move(file));
}

}  // namespace fascicle::client
