#include "client/render/rest_outline.h"

#include <vtkCell.h>
#include <vtkCellArray.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPoints.h>

#include <Eigen/Geometry>
#include <array>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace fascicle::client {
namespace {

using Place = std::array<double, 3>;

// The normals of the faces beside an edge.
struct EdgeSides {
  Vec3 first = Vec3::Zero();
  std::optional<Vec3> second;
};

// Points that were split for shading count as one: edges are named by their places.
std::map<std::pair<Place, Place>, EdgeSides> EdgesOf(vtkPolyData& surface) {
  std::map<std::pair<Place, Place>, EdgeSides> edges;
  vtkNew<vtkIdList> ids;
  for (vtkIdType cell = 0; cell < surface.GetNumberOfCells(); ++cell) {
    surface.GetCellPoints(cell, ids);
    const vtkIdType count = ids->GetNumberOfIds();
    if (count < 3) continue;
    std::vector<Place> corners(static_cast<std::size_t>(count));
    for (vtkIdType i = 0; i < count; ++i) surface.GetPoint(ids->GetId(i), corners[static_cast<std::size_t>(i)].data());
    const auto at = [&](std::size_t i) { return Vec3(corners[i].data()); };
    const Vec3 normal = (at(1) - at(0)).cross(at(2) - at(0)).normalized();
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Place& a = corners[i];
      const Place& b = corners[(i + 1) % corners.size()];
      const auto [edge, is_new] = edges.try_emplace(std::minmax(a, b), EdgeSides{normal, std::nullopt});
      if (!is_new) edge->second.second = normal;
    }
  }
  return edges;
}

bool IsDrawn(const EdgeSides& sides, const Vec3& eye, bool sharp) {
  constexpr double kCosine = 0.5;  // of 60 degrees
  if (!sides.second) return true;  // the border of an open surface
  const bool front = sides.first.dot(eye) > 0, other_front = sides.second->dot(eye) > 0;
  return front != other_front || (sharp && front && sides.first.dot(*sides.second) < kCosine);
}

}  // namespace

vtkSmartPointer<vtkPolyData> MakeRestOutline(vtkPolyData& surface, const Vec3& eye, bool sharp) {
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkCellArray> lines;
  for (const auto& [ends, sides] : EdgesOf(surface)) {
    if (!IsDrawn(sides, eye, sharp)) continue;
    const vtkIdType a = points->InsertNextPoint(ends.first.data()), b = points->InsertNextPoint(ends.second.data());
    lines->InsertNextCell({a, b});
  }
  auto outline = vtkSmartPointer<vtkPolyData>::New();
  outline->SetPoints(points);
  outline->SetLines(lines);
  return outline;
}

}  // namespace fascicle::client
