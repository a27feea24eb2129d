#include "client/export/read_series.h"

#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkInformation.h>
#include <vtkInformationStringKey.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <pugixml.hpp>
#include <stdexcept>

#include "client/vtk/body_grid.h"
#include "core/base/component_names.h"
#include "core/geometry/solid_cells.h"

namespace fascicle::client {
namespace {

namespace fs = std::filesystem;

constexpr const char* kIndex = "frames.pvd";
constexpr const char* kRegion = "region/";

// The number at the end of `frames/belly_000007.vtu`.
std::int64_t FrameOf(const fs::path& file) {
  const std::string stem = file.stem().string();
  std::int64_t frame = -1;
  const char* const begin = stem.data() + stem.rfind('_') + 1;
  if (stem.find('_') == std::string::npos ||
      std::from_chars(begin, stem.data() + stem.size(), frame).ec != std::errc()) {
    throw std::runtime_error(file.string() + " has no number of a frame in its name");
  }
  return frame;
}

std::vector<double> ValuesOf(vtkDataArray& array) {
  std::vector<double> values;
  const int components = array.GetNumberOfComponents();
  values.reserve(static_cast<std::size_t>(array.GetNumberOfTuples() * components));
  for (vtkIdType i = 0; i < array.GetNumberOfTuples(); ++i) {
    for (int c = 0; c < components; ++c) values.push_back(array.GetComponent(i, c));
  }
  return values;
}

std::string UnitOf(vtkDataArray& array) {
  vtkInformation* const information = array.GetInformation();
  const char* const unit = information->Get(vtkDataArray::UNITS_LABEL());
  return unit == nullptr ? "" : unit;
}

void AddArrays(vtkFieldData& data, bool at_nodes, BodySnapshot& body) {
  for (int k = 0; k < data.GetNumberOfArrays(); ++k) {
    vtkDataArray* const array = data.GetArray(k);
    if (array == nullptr || array->GetName() == nullptr) continue;
    const std::string name = array->GetName();
    if (name.starts_with(kRegion)) {
      BodyShape::Region region = {name.substr(std::string(kRegion).size()), {}};
      for (vtkIdType i = 0; i < array->GetNumberOfTuples(); ++i) {
        if (array->GetComponent(i, 0) != 0) region.nodes.push_back(static_cast<std::uint32_t>(i));
      }
      body.shape.regions.push_back(std::move(region));
    } else if (name != "rest_fibre") {
      const auto components = static_cast<std::size_t>(array->GetNumberOfComponents());
      body.fields.push_back({name, UnitOf(*array), ComponentNames(name, components), at_nodes, ValuesOf(*array)});
    }
  }
}

// A wedge or pyramid as a brick with repeated nodes.
void AddSolid(SolidShape kind, const std::array<std::uint32_t, 8>& nodes, BodyShape& shape) {
  const std::array<std::uint32_t, 8> hexahedron = AsHexahedron(kind, nodes);
  std::array<std::uint32_t, 8>& brick = shape.bricks.emplace_back();
  for (std::size_t c = 0; c < 8; ++c) brick[kHexahedronCorners[c]] = hexahedron[c];
}

void AddCells(vtkUnstructuredGrid& grid, const fs::path& file, BodyShape& shape) {
  for (vtkIdType e = 0; e < grid.GetNumberOfCells(); ++e) {
    vtkIdType count = 0;
    const vtkIdType* nodes = nullptr;
    grid.GetCellPoints(e, count, nodes);
    const auto node = [&](std::size_t c) { return static_cast<std::uint32_t>(nodes[c]); };
    switch (grid.GetCellType(e)) {
      case 10:
        shape.tetrahedra.push_back({node(0), node(1), node(2), node(3)});
        break;
      case 24:
        shape.tetrahedra.push_back({node(0), node(1), node(2), node(3)});
        shape.mid_edges.push_back({node(4), node(5), node(6), node(7), node(8), node(9)});
        break;
      case 12: {
        std::array<std::uint32_t, 8> brick;
        for (std::size_t c = 0; c < 8; ++c) brick[kHexahedronCorners[c]] = node(c);
        shape.bricks.push_back(brick);
        break;
      }
      case 13:  // a wedge, with its base seen from outside
        AddSolid(SolidShape::kWedge, {node(0), node(2), node(1), node(3), node(5), node(4)}, shape);
        break;
      case 14:
        AddSolid(SolidShape::kPyramid, {node(0), node(1), node(2), node(3), node(4)}, shape);
        break;
      case 5:
        shape.triangles.push_back({node(0), node(1), node(2)});
        break;
      default:
        throw std::runtime_error(file.string() + " has cells that `fascicle export` does not write");
    }
  }
}

BodySnapshot ReadBody(const ExportedFrame::Body& source) {
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName(source.file.c_str());
  if (reader->CanReadFile(source.file.c_str()) == 0) throw std::runtime_error("can't read " + source.file.string());
  reader->Update();
  vtkUnstructuredGrid& grid = *reader->GetOutput();
  BodySnapshot body;
  body.shape.name = source.name;
  AddCells(grid, source.file, body.shape);
  AddArrays(*grid.GetPointData(), true, body);
  AddArrays(*grid.GetCellData(), false, body);
  const auto displacement = std::find_if(body.fields.begin(), body.fields.end(),
                                         [](const BodyField& field) { return field.name == "displacement"; });
  if (displacement == body.fields.end()) throw std::runtime_error(source.file.string() + " has no displacement");
  for (vtkIdType i = 0; i < grid.GetNumberOfPoints(); ++i) {
    const Vec3 x(grid.GetPoint(i));
    body.positions.push_back(x);
    body.shape.positions.emplace_back(x -
                                      Eigen::Map<const Vec3>(&displacement->values[3 * static_cast<std::size_t>(i)]));
  }
  return body;
}

}  // namespace

bool HasSeries(const fs::path& folder) { return fs::exists(folder / kIndex); }

std::vector<ExportedFrame> ReadSeriesIndex(const fs::path& folder) {
  pugi::xml_document document;
  const fs::path path = folder / kIndex;
  if (!document.load_file(path.c_str())) throw std::runtime_error("can't read " + path.string());
  std::map<std::int64_t, ExportedFrame> frames;
  for (const pugi::xml_node& entry : document.child("VTKFile").child("Collection").children("DataSet")) {
    const fs::path file = entry.attribute("file").value();
    if (file.extension() != ".vtu") continue;
    const std::int64_t number = FrameOf(file);
    ExportedFrame& frame = frames[number];
    frame.frame = number;
    frame.time = entry.attribute("timestep").as_double();
    frame.bodies.push_back({entry.attribute("name").value(), folder / file});
  }
  std::vector<ExportedFrame> ordered;
  for (auto& [number, frame] : frames) ordered.push_back(std::move(frame));
  if (ordered.empty()) throw std::runtime_error(path.string() + " lists no bodies");
  return ordered;
}

Snapshot ReadSnapshot(const ExportedFrame& frame) {
  Snapshot snapshot = {frame.frame, frame.time, {}};
  for (const ExportedFrame::Body& body : frame.bodies) snapshot.bodies.push_back(ReadBody(body));
  return snapshot;
}

}  // namespace fascicle::client
