#include "core/sim/job_size.h"

#include <cmath>

#include "core/eulerian/scene_body.h"
#include "core/scene/output_fields.h"

namespace fascicle {
namespace {

// Measured with isometric muscles and cubes of 1,000 to 500,000 unknowns [byte].
constexpr double kPerVoxel = 600;
constexpr double kPerCell = 1200;
constexpr double kPerExplicitPoint = 320;  // of tetrahedra and hexahedra
// A node's share of the matrix, its levels, and the vectors of the solver.
constexpr double kPerLinearNode = 8'000, kPerQuadraticNode = 13'000, kPerHexahedralNode = 12'000,
                 kPerQuadraticHexahedralNode = 25'000;

double PerNode(ElementOrder order) {
  switch (order) {
    case ElementOrder::kLinear:
      return kPerLinearNode;
    case ElementOrder::kQuadratic:
      return kPerQuadraticNode;
    case ElementOrder::kHexahedral:
      return kPerHexahedralNode;
    case ElementOrder::kHexahedralQuadratic:
      break;
  }
  return kPerQuadraticHexahedralNode;
}

// Factors of a matrix of n unknowns from a body of three dimensions, by nested dissection: of the order n^(4/3)
// [George 1973].
constexpr double kPerFactor = 300;

struct TetSize {
  double nodes = 0, elements = 0, points = 0;
};

TetSize TetSizeOf(const TetMesh& mesh, ElementOrder order) {
  const auto nodes = static_cast<double>(mesh.nodes.size());
  const auto hexahedra = static_cast<double>(mesh.hexahedra.size());
  if (order == ElementOrder::kHexahedral) return {nodes, hexahedra, 8 * hexahedra};
  if (order == ElementOrder::kHexahedralQuadratic) return {8 * nodes, hexahedra, 27 * hexahedra};
  const auto tetrahedra = static_cast<double>(mesh.tetrahedra.size());
  if (order == ElementOrder::kLinear) return {nodes, tetrahedra, tetrahedra};
  // A mesh has about as many edges as nodes and tetrahedra [Euler's formula].
  return {2 * nodes + tetrahedra, tetrahedra, 4 * tetrahedra};
}

double TetMemory(const TetMethod& method, const TetSize& size) {
  const double explicit_memory = kPerExplicitPoint * size.points;
  if (method.stepping == Stepping::kExplicit || method.stepping == Stepping::kMixed) return explicit_memory;
  const double factors =
      method.linear_solver == LinearSolver::kDirect ? kPerFactor * std::pow(3 * size.nodes, 4. / 3) : 0;
  return explicit_memory + PerNode(method.element) * size.nodes + factors;
}

double MemoryOf(const Scene& scene) {
  double memory = 0;
  TetSize tet;
  for (const Body& body : scene.bodies) {
    switch (scene.method) {
      case Method::kTet: {
        const TetSize size = TetSizeOf(body.tet().mesh, scene.tet.element);
        tet.nodes += size.nodes;
        tet.elements += size.elements;
        tet.points += size.points;
        break;
      }
      case Method::kVoxel:
        memory += kPerVoxel * static_cast<double>(body.voxel().mesh.bricks.size());
        break;
      case Method::kEulerian:
        memory += kPerCell * static_cast<double>(GridOf(scene.eulerian, body.surface().mesh).cell_count());
        break;
    }
  }
  return memory + TetMemory(scene.tet, tet);
}

double SizeOfFrame(const Scene& scene) {
  double bytes = 0;
  for (const Body& body : scene.bodies) {
    bytes += static_cast<double>(body.nodes().size() * sizeof(Vec3));
    for (const OutputField field : scene.output.fields) {
      const OutputFieldInfo& info = InfoOf(field);
      bytes += static_cast<double>(static_cast<std::size_t>(info.components) * sizeof(double) *
                                   static_cast<std::size_t>(PlacesOf(info, body.shape)));
    }
  }
  return bytes;
}

}  // namespace

JobSize JobSizeOf(const Scene& scene) {
  const double frames = std::ceil(scene.duration / scene.output.frame_interval) + 1;
  return {MemoryOf(scene), frames * SizeOfFrame(scene)};
}

}  // namespace fascicle
