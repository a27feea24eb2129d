#include "client/export/vtk_series.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkSmartPointer.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <pugixml.hpp>
#include <sstream>
#include <stdexcept>

#include "client/lib/replace_file.h"

namespace fascicle::client {
namespace {

namespace fs = std::filesystem;

vtkSmartPointer<vtkDoubleArray> MakeArray(const std::string& name, int components, std::size_t tuples) {
  auto array = vtkSmartPointer<vtkDoubleArray>::New();
  array->SetName(name.c_str());
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(static_cast<vtkIdType>(tuples));
  return array;
}

vtkSmartPointer<vtkDoubleArray> MakeArray(const std::string& name, int components, const std::vector<double>& values) {
  const auto array = MakeArray(name, components, values.size() / static_cast<std::size_t>(components));
  std::copy(values.begin(), values.end(), array->GetPointer(0));
  return array;
}

void SetMesh(const BodyShape& shape, const std::vector<Vec3>& positions, vtkUnstructuredGrid& grid) {
  const auto coordinates = MakeArray("Points", 3, positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    coordinates->SetTypedTuple(static_cast<vtkIdType>(i), positions[i].data());
  }
  vtkNew<vtkPoints> points;
  points->SetData(coordinates);
  grid.SetPoints(points);
  vtkNew<vtkCellArray> cells;
  cells->AllocateExact(
      static_cast<vtkIdType>(shape.elements()),
      static_cast<vtkIdType>(4 * shape.tetrahedra.size() + 8 * shape.bricks.size() + 3 * shape.triangles.size()));
  for (const auto& t : shape.tetrahedra)
    cells->InsertNextCell({vtkIdType{t[0]}, vtkIdType{t[1]}, vtkIdType{t[2]}, vtkIdType{t[3]}});
  for (const auto& brick : shape.bricks) {
    std::array<vtkIdType, 8> nodes;
    for (std::size_t c = 0; c < 8; ++c) nodes[c] = brick[kHexahedronCorners[c]];
    cells->InsertNextCell(8, nodes.data());
  }
  for (const auto& t : shape.triangles) cells->InsertNextCell({vtkIdType{t[0]}, vtkIdType{t[1]}, vtkIdType{t[2]}});
  grid.SetCells(CellTypeOf(shape), cells);
}

void AddDisplacement(const BodyShape& shape, const std::vector<Vec3>& positions, vtkUnstructuredGrid& grid) {
  const auto displacement = MakeArray("displacement", 3, positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec3 u = positions[i] - shape.positions[i];
    displacement->SetTypedTuple(static_cast<vtkIdType>(i), u.data());
  }
  grid.GetPointData()->AddArray(displacement);
}

void AddRegions(const BodyShape& shape, vtkUnstructuredGrid& grid) {
  for (const BodyShape::Region& region : shape.regions) {
    vtkNew<vtkUnsignedCharArray> flags;
    flags->SetName(("region/" + region.name).c_str());
    flags->SetNumberOfTuples(static_cast<vtkIdType>(shape.positions.size()));
    flags->Fill(0);
    for (const std::uint32_t node : region.nodes) flags->SetValue(node, 1);
    grid.GetPointData()->AddArray(flags);
  }
}

void AddRestFibres(const BodyShape& shape, vtkUnstructuredGrid& grid) {
  if (shape.fibres.empty()) return;
  const auto fibres = MakeArray("rest_fibre", 3, shape.fibres.size());
  for (std::size_t i = 0; i < shape.fibres.size(); ++i) {
    fibres->SetTypedTuple(static_cast<vtkIdType>(i), shape.fibres[i].data());
  }
  grid.GetCellData()->AddArray(fibres);
}

void WriteBody(const BodyShape& shape, const v1::BodyFrame& frame, const fs::path& path) {
  const std::vector<Vec3> positions = DecodePositions(frame, shape.positions.size());
  vtkNew<vtkUnstructuredGrid> grid;
  SetMesh(shape, positions, *grid);
  AddDisplacement(shape, positions, *grid);
  AddRegions(shape, *grid);
  AddRestFibres(shape, *grid);
  for (const v1::FieldValues& field : frame.fields()) {
    const auto array = MakeArray(field.name(), field.components(), DecodeField(field, shape));
    const bool at_nodes = field.location() == v1::FieldValues::LOCATION_NODE;
    (at_nodes ? static_cast<vtkFieldData*>(grid->GetPointData()) : grid->GetCellData())->AddArray(array);
  }
  ReplaceFile(path, [&](const fs::path& beside) {
    vtkNew<vtkXMLUnstructuredGridWriter> writer;
    writer->SetInputData(grid);
    writer->SetFileName(beside.c_str());
    writer->SetDataModeToAppended();
    writer->EncodeAppendedDataOff();
    writer->SetCompressorTypeToZLib();
    if (writer->Write() != 1)
      throw std::runtime_error("can't write " + path.string() + ": no permission, or no space left");
  });
}

std::string FileName(const std::string& body, std::int64_t frame) {
  char number[32];
  std::snprintf(number, sizeof number, "%06lld", static_cast<long long>(frame));
  return "frames/" + body + "_" + number + ".vtu";
}

// Shortest text that reads back as the same number.
std::string Exact(double value) {
  char text[32];
  return std::string(text, std::to_chars(text, text + sizeof text, value).ptr);
}

}  // namespace

VtkSeriesWriter::VtkSeriesWriter(const v1::Geometry& geometry, fs::path folder)
    : folder_(std::move(folder)), shapes_(DecodeGeometry(geometry)) {
  // Names come from the server, which checks them. They must not lead out of the folder in any case.
  for (const BodyShape& shape : shapes_) {
    if (shape.name.empty() || shape.name.find('/') != std::string::npos) {
      throw std::runtime_error("the server sent a body with the unusable name \"" + shape.name + "\"");
    }
  }
}

void VtkSeriesWriter::Add(const v1::Frame& frame) {
  if (static_cast<std::size_t>(frame.bodies_size()) != shapes_.size()) {
    throw std::runtime_error("the server sent a frame that doesn't fit its geometry");
  }
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    const std::string file = FileName(shapes_[i].name, frame.index());
    WriteBody(shapes_[i], frame.bodies(static_cast<int>(i)), folder_ / file);
    entries_.push_back({frame.time(), i, file});
  }
}

void VtkSeriesWriter::Finish() const {
  pugi::xml_document document;
  pugi::xml_node root = document.append_child("VTKFile");
  root.append_attribute("type") = "Collection";
  root.append_attribute("version") = "0.1";
  root.append_attribute("byte_order") = "LittleEndian";
  pugi::xml_node collection = root.append_child("Collection");
  for (const Entry& entry : entries_) {
    pugi::xml_node data_set = collection.append_child("DataSet");
    data_set.append_attribute("timestep") = Exact(entry.time).c_str();
    data_set.append_attribute("part") = static_cast<unsigned long long>(entry.body);
    data_set.append_attribute("name") = shapes_[entry.body].name.c_str();
    data_set.append_attribute("file") = entry.file.c_str();
  }
  std::ostringstream text;
  document.save(text, "  ");
  ReplaceFile(folder_ / "frames.pvd", text.str());
}

}  // namespace fascicle::client
