#include "server/translate/start.h"

#include <algorithm>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "core/geometry/mesh_edges.h"
#include "fascicle/v1/frame.pb.h"
#include "server/translate/files.h"
#include "server/translate/values.h"

namespace fascicle::server {
namespace {

constexpr const char* kFrame = "start.frame";

template <class T>
std::vector<T> ArrayOf(const std::string& bytes) {
  std::vector<T> values(bytes.size() / sizeof(T));
  if (!values.empty()) std::memcpy(static_cast<void*>(values.data()), bytes.data(), values.size() * sizeof(T));
  return values;
}

// The mesh nodes' values, then those of higher-order nodes.
std::vector<Vec3> PositionsOf(const v1::BodyFrame& frame) {
  std::vector<Vec3> positions = ArrayOf<Vec3>(frame.positions());
  const std::vector<Vec3> more = ArrayOf<Vec3>(frame.higher_order_positions());
  positions.insert(positions.end(), more.begin(), more.end());
  return positions;
}

// The velocities of the same nodes; empty if the frame has none.
std::vector<Vec3> VelocitiesOf(const v1::BodyFrame& frame) {
  for (const v1::FieldValues& field : frame.fields()) {
    if (field.name() != "velocity") continue;
    return ArrayOf<Vec3>(field.all_values().empty() ? field.values() : field.all_values());
  }
  return {};
}

bool AreNear(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  if (a.size() != b.size()) return false;
  double size = 0, distance = 0;
  for (std::size_t n = 0; n < a.size(); ++n) {
    size = std::max(size, (a[n] - a[0]).norm());
    distance = std::max(distance, (a[n] - b[n]).norm());
  }
  return distance <= 1e-9 * size;
}

// The higher-order nodes of the elements as frames number them.
std::vector<std::int32_t> HigherOrderNodesOf(const TetMesh& mesh, const MeshEdges& edges) {
  std::vector<std::int32_t> nodes;
  nodes.reserve(6 * edges.of_tetrahedra.size());
  for (const std::array<std::int32_t, 6>& of_tetrahedron : edges.of_tetrahedra) {
    for (const std::int32_t edge : of_tetrahedron) nodes.push_back(static_cast<std::int32_t>(mesh.nodes.size()) + edge);
  }
  return nodes;
}

// Puts the state of one body into the scene.
class BodyStart {
 public:
  BodyStart(const v1::BodyGeometry& geometry, const v1::BodyFrame& frame, ElementOrder order, Body& body,
            Problems& problems)
      : geometry_(geometry), frame_(frame), order_(order), body_(body), problems_(problems) {}

  void Translate() {
    if (geometry_.name() != body_.name) {
      return Refuse("is of a body `" + geometry_.name() + "`, where this scene has `" + body_.name + "`",
                    "the scenes must have the same bodies in the same order");
    }
    TetShape& shape = body_.tet();
    if (!IsSameMesh(shape.mesh)) {
      return Refuse("has another mesh for `" + body_.name + "`",
                    "use the same mesh, unit, refinements and kind of elements");
    }
    const MeshEdges edges = order_ == ElementOrder::kQuadratic ? NumberEdges(shape.mesh) : MeshEdges();
    if (!HasSameNodes(shape.mesh, edges)) return;
    std::vector<Vec3> rest = shape.mesh.nodes;
    const std::vector<Vec3> middles = EdgeMiddlesOf(shape.mesh, edges);
    rest.insert(rest.end(), middles.begin(), middles.end());
    std::vector<Vec3> displacement = PositionsOf(frame_);
    std::vector<Vec3> velocity = VelocitiesOf(frame_);
    if (displacement.size() != rest.size() || (!velocity.empty() && velocity.size() != rest.size())) {
      return Refuse("is damaged: positions or velocities of `" + body_.name + "` don't fit its mesh", "");
    }
    for (std::size_t n = 0; n < rest.size(); ++n) displacement[n] -= rest[n];
    shape.initial_displacement = std::move(displacement);
    shape.initial_velocity = std::move(velocity);
  }

 private:
  void Refuse(std::string message, std::string hint) { problems_.Add(kFrame, std::move(message), std::move(hint)); }

  bool IsSameMesh(const TetMesh& mesh) const {
    v1::BodyGeometry own;
    EncodeElements(body_.tet(), own);
    return own.tetrahedra() == geometry_.tetrahedra() && own.bricks() == geometry_.bricks() &&
           AreNear(mesh.nodes, ArrayOf<Vec3>(geometry_.positions()));
  }

  bool HasSameNodes(const TetMesh& mesh, const MeshEdges& edges) {
    const std::vector<std::int32_t> nodes = ArrayOf<std::int32_t>(geometry_.higher_order_nodes());
    if (nodes == HigherOrderNodesOf(mesh, edges)) return true;
    if (nodes.empty()) {
      Refuse("has corner nodes of `" + body_.name + "` only, but this scene's elements are quadratic",
             "start from a job with quadratic elements, or set `tet.element` to LINEAR; run jobs of older versions "
             "again, whose frames lack mid-edge nodes");
    } else {
      Refuse("has other mid-edge nodes of `" + body_.name + "` than this scene's elements",
             "the job and this scene need the same `tet.element`");
    }
    return false;
  }

  std::vector<Vec3> EdgeMiddlesOf(const TetMesh& mesh, const MeshEdges& edges) const {
    return order_ == ElementOrder::kQuadratic ? EdgeMiddles(mesh, edges) : std::vector<Vec3>();
  }

  const v1::BodyGeometry& geometry_;
  const v1::BodyFrame& frame_;
  const ElementOrder order_;
  Body& body_;
  Problems& problems_;
};

bool IsViscoelastic(const Body& body) {
  const auto has_terms = [](const PronySeries& series) { return !series.terms.empty(); };
  return has_terms(body.viscoelasticity) ||
         std::any_of(body.tet().viscoelasticity.begin(), body.tet().viscoelasticity.end(), has_terms);
}

void AddNote(const v1::FrameStart& start, const v1::Frame& frame, std::vector<Body>& bodies) {
  std::string note = std::string(kFrame) + ": begins as frame " + std::to_string(frame.index()) + " (" +
                     Text(frame.time()) + " s)" + (start.job().empty() ? "" : " of " + start.job());
  if (bodies.front().tet().initial_velocity.empty()) {
    note += "; at rest, since it has no velocities (`velocity` in output.fields)";
  }
  if (std::any_of(bodies.begin(), bodies.end(), IsViscoelastic)) note += "; viscoelastic stresses are relaxed";
  bodies.front().notes.push_back(std::move(note));
}

void TranslateFrame(const v1::Scene& wire, const AssetReader& assets, Scene& scene, Problems& problems) {
  const v1::FrameStart& start = wire.start().frame();
  scene.start.frame = true;
  for (int i = 0; i < wire.bodies_size(); ++i) {
    const std::string path = IndexPath("bodies", static_cast<std::size_t>(i));
    for (const auto& [given, field] : {std::pair(wire.bodies(i).has_initial_displacement(), "initial_displacement"),
                                       std::pair(wire.bodies(i).has_initial_velocity(), "initial_velocity")}) {
      if (given) problems.Add(JoinPath(path, field), "is given beside start.frame, which has its values", "omit it");
    }
  }
  if (!start.has_state()) {
    return problems.Add(JoinPath(kFrame, "job"), "is missing", "jobs/ID, such as `fascicle list` prints it");
  }
  v1::FileRef file = start.state();
  if (file.path().empty()) file.set_path("frame");  // it has one format only
  const auto bytes = ReadFile(file, JoinPath(kFrame, "state"), assets, problems);
  if (!bytes || scene.method != Method::kTet) return;
  v1::FrameState state;
  if (!state.ParseFromString(*bytes) || state.geometry().bodies_size() != state.frame().bodies_size()) {
    return problems.Add(JoinPath(kFrame, "state"), "is not a frame of a job", "give `job` in place of it");
  }
  const int count = static_cast<int>(scene.bodies.size());
  if (state.frame().bodies_size() != count || count == 0) {
    return problems.Add(
        kFrame,
        "has " + std::to_string(state.frame().bodies_size()) + " bodies, where this scene has " + std::to_string(count),
        "the scenes must have the same bodies in the same order");
  }
  const std::size_t before = problems.count();
  for (int b = 0; b < count; ++b) {
    Body& body = scene.bodies[static_cast<std::size_t>(b)];
    if (body.tet().mesh.nodes.empty()) continue;  // reported with the body
    BodyStart(state.geometry().bodies(b), state.frame().bodies(b), scene.tet.element, body, problems).Translate();
  }
  if (problems.count() == before) AddNote(start, state.frame(), scene.bodies);
}

}  // namespace

void TranslateStart(const v1::Scene& wire, const AssetReader& assets, Scene& scene, Problems& problems) {
  if (!wire.has_start()) return;
  scene.start.equilibrium = wire.start().has_equilibrium();
  if (wire.start().has_frame()) TranslateFrame(wire, assets, scene, problems);
  if (!scene.start.equilibrium) return;
  for (int i = 0; i < wire.bodies_size(); ++i) {
    if (!wire.bodies(i).has_initial_velocity()) continue;
    problems.Add(JoinPath(IndexPath("bodies", static_cast<std::size_t>(i)), "initial_velocity"),
                 "has no effect: the scene starts in equilibrium", "omit it, or `start`");
  }
}

}  // namespace fascicle::server
