#ifndef FASCICLE_TESTS_SUPPORT_TET_SCENES_H_
#define FASCICLE_TESTS_SUPPORT_TET_SCENES_H_

#include <array>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "core/geometry/shapes.h"
#include "core/sim/simulation.h"
#include "core/tet/solver.h"

// Small bodies and states that several tests share.
namespace fascicle::testing {

// A body with the regions x0 x1 y0 y1 z0 z1: the nodes and triangles on the six sides of its bounding box.
inline Body MakeBody(std::string name, TetMesh mesh, Material material) {
  Body body;
  body.name = std::move(name);
  body.tet().mesh = std::move(mesh);
  body.material = std::move(material);
  const TetMesh& of_body = body.tet().mesh;
  const std::vector<Triangle> surface = BoundaryTriangles(of_body);
  const HexahedralBoundary boundary = BoundaryOfHexahedra(of_body);
  const auto select = [&](std::string region, const Selector& selector) {
    body.regions.push_back(of_body.hexahedra.empty() ? SelectRegion(of_body, surface, std::move(region), selector)
                                                     : SelectRegion(of_body, boundary, std::move(region), selector));
  };
  Vec3 low = body.tet().mesh.nodes[0], high = low;
  for (const Vec3& X : body.tet().mesh.nodes) {
    low = low.cwiseMin(X);
    high = high.cwiseMax(X);
  }
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 normal = Vec3::Unit(axis);
    const std::string letter(1, "xyz"[axis]);
    select(letter + "0", PlaneSelector{low, -normal});
    select(letter + "1", PlaneSelector{high, normal});
  }
  return body;
}

enum Side { kX0, kX1, kY0, kY1, kZ0, kZ1 };

inline constexpr std::array kEveryElement = {ElementOrder::kLinear, ElementOrder::kQuadratic, ElementOrder::kHexahedral,
                                             ElementOrder::kHexahedralQuadratic};
// The name in a scene, in small letters.
inline std::string ElementNameOf(ElementOrder element) {
  constexpr std::array kNames = {"linear", "quadratic", "hexahedral", "hexahedral_quadratic"};
  return kNames[static_cast<std::size_t>(element)];
}

// The cells that an element needs.
inline Cells CellsOf(ElementOrder element) { return IsHexahedral(element) ? Cells::kHexahedra : Cells::kTetrahedra; }

inline Body BoxBody(const Vec3& size, const std::array<int, 3>& divisions, Material material,
                    Cells cells = Cells::kTetrahedra) {
  return MakeBody("box", MakeBox(Vec3::Zero(), size, divisions, cells), std::move(material));
}

inline Constraint Fix(Side side, std::array<bool, 3> axes = {true, true, true}) {
  return Constraint{static_cast<std::int32_t>(side), axes, {}};
}

// Every law with usable parameters, in the order of the list; soft enough that all have wave speeds of a few m/s.
// Fibres that begin to pull at rest are soft there and stiffen later: the tangent at rest, by which stable steps are
// judged, is that of slack fibres.
inline std::vector<Material> EveryLaw() {
  return {LinearElastic(std::array{1e4, 0.3}),
          StVenantKirchhoff(std::array{1e4, 0.3}),
          CorotatedLinear(std::array{1e4, 0.3}),
          NeoHookean(std::array{1e4, 0.3}),
          MooneyRivlin(std::array{2e3, 1e3, 2e4}),
          Muscle(std::array{5e2, 5e2, 1e5, 3e4, 1.2, 0.05, 6.6, 1.4}),
          Tendon(std::array{5e3, 5e3, 1e6, 2.7e4, 20.0, 1.03}),
          TransIsoMooneyRivlin(std::array{2e3, 1e3, 5e2, 8.0, 5e4, 1.2, 2e4, 1e4}),
          Yeoh(std::array{3e3, -2e2, 5e2, 2e4}),
          Ogden(std::array{4e3, 1.3, 3e2, 5.0, 2e3, -2.0, 2e4}),
          FungFibre(std::array{2e3, 1e3, 1e2, 4.0, 2e4}),
          HolzapfelGasserOgden(std::array{6e3, 50.0, 20.0, 0.1, 0.6, 0.0, 0.3, 1.0, 2e4}),
          TabulatedMuscle(std::array{2e3, -1e2, 3e2, 2e4, 1e4, 1.1, 0.0}),
          BlemkerMuscle(std::array{2e3, 3e3, 1e5, 3e4, 1.2, 0.05, 6.6, 1.4}),
          BlemkerTendon(std::array{5e3, 4e3, 1e6, 2.7e4, 20.0, 1.03})};
}
inline constexpr int kLaws = std::variant_size_v<Material>;

// A scene of one body, with fibres along x where the law needs them.
inline Scene OneBody(Body body) {
  if (body.tet().fibres.empty()) body.tet().fibres = ConstantFibres(body.tet().mesh, Vec3(1, 0.3, 0.2));
  Scene scene;
  scene.name = body.name;
  scene.bodies.push_back(std::move(body));
  scene.duration = 1;
  scene.output.frame_interval = 0.1;
  return scene;
}

// Nodes displaced at random by at most `amplitude` along each axis.
inline NodalVector Shaken(const NodalVector& X, double amplitude, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> shift(-amplitude, amplitude);
  NodalVector x = X;
  for (Vec3& position : x) {
    for (int c = 0; c < 3; ++c) position[c] += shift(random);
  }
  return x;
}

inline NodalVector RandomVectors(std::size_t count, unsigned seed) {
  return Shaken(NodalVector(count, Vec3::Zero()), 1, seed);
}

inline double LargestNorm(const NodalVector& vectors) {
  double largest = 0;
  for (const Vec3& v : vectors) largest = std::max(largest, v.norm());
  return largest;
}

inline double LargestDifference(const NodalVector& a, const NodalVector& b) {
  double largest = 0;
  for (std::size_t n = 0; n < a.size(); ++n) largest = std::max(largest, (a[n] - b[n]).norm());
  return largest;
}

// Keeps all output of a run.
class CollectingSink : public FrameSink {
 public:
  bool PutFrame(Frame frame, std::string checkpoint) override {
    frames.push_back(std::move(frame));
    checkpoints.push_back(std::move(checkpoint));
    return true;
  }
  void PutProgress(const Progress& now) override { progress = now; }

  std::vector<Frame> frames;
  std::vector<std::string> checkpoints;
  Progress progress;
};

struct RunResult {
  Outcome outcome;
  std::vector<Frame> frames;
  std::vector<std::string> checkpoints;
  std::vector<SeriesInfo> series;
  Progress progress;

  // The value of a series in a frame.
  double At(std::size_t frame, const std::string& name) const {
    for (std::size_t i = 0; i < series.size(); ++i) {
      if (series[i].name == name) return frames.at(frame).series.at(i);
    }
    throw std::out_of_range("no series " + name);
  }
  double Last(const std::string& name) const { return At(frames.size() - 1, name); }
};

// Runs a scene from rest, with a checkpoint at every frame.
inline RunResult RunScene(const Scene& scene, int threads = 1) {
  Simulation simulation(std::make_shared<Scene>(scene), threads);
  CollectingSink sink;
  RunResult result;
  result.outcome = simulation.Run(sink, {}, std::chrono::milliseconds(0));
  result.series = simulation.layout().series;
  result.frames = std::move(sink.frames);
  result.checkpoints = std::move(sink.checkpoints);
  result.progress = sink.progress;
  return result;
}

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_SUPPORT_TET_SCENES_H_
