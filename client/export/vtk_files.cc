#include "client/export/vtk_files.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkInformation.h>
#include <vtkInformationStringKey.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLPolyDataWriter.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <algorithm>
#include <array>
#include <stdexcept>

#include "client/lib/replace_file.h"
#include "client/vtk/body_grid.h"

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

void SetUnit(vtkDoubleArray& array, const std::string& unit) {
  array.GetInformation()->Set(vtkDataArray::UNITS_LABEL(), unit.c_str());
}

void AddDisplacement(const BodyShape& shape, const std::vector<Vec3>& positions, vtkUnstructuredGrid& grid) {
  const auto displacement = MakeArray("displacement", 3, positions.size());
  SetUnit(*displacement, "m");
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

template <class Writer, class Data>
void WriteData(Data& data, const fs::path& path) {
  ReplaceFile(path, [&](const fs::path& beside) {
    vtkNew<Writer> writer;
    writer->SetInputData(&data);
    writer->SetFileName(beside.c_str());
    writer->SetDataModeToAppended();
    writer->EncodeAppendedDataOff();
    writer->SetCompressorTypeToZLib();
    writer->SetCompressionLevel(1);  // a third of the time of the default for a few per cent more bytes
    if (writer->Write() != 1)
      throw std::runtime_error("can't write " + path.string() + ": no permission, or no space left");
  });
}

}  // namespace

void WriteBody(const BodyShape& shape, const v1::BodyFrame& frame, const fs::path& path) {
  const std::vector<Vec3> positions = DecodePositions(frame, shape.positions.size());
  const auto grid = MakeGrid(shape, positions);
  AddDisplacement(shape, positions, *grid);
  AddRegions(shape, *grid);
  AddRestFibres(shape, *grid);
  for (const v1::FieldValues& field : frame.fields()) {
    const auto array = MakeArray(field.name(), field.components(), DecodeField(field, shape));
    SetUnit(*array, field.unit());
    const bool at_nodes = field.location() == v1::FieldValues::LOCATION_NODE;
    (at_nodes ? static_cast<vtkFieldData*>(grid->GetPointData()) : grid->GetCellData())->AddArray(array);
  }
  WriteData<vtkXMLUnstructuredGridWriter>(*grid, path);
}

void WriteRigidBody(const RigidShape& body, const Pose& pose, const fs::path& path) {
  vtkNew<vtkPolyData> surface;
  surface->SetPoints(MakePoints(PositionsAt(body, pose)));
  surface->SetPolys(MakeTriangles(body.triangles));
  WriteData<vtkXMLPolyDataWriter>(*surface, path);
}

void WriteLine(const LineInfo& line, const LinePath& state, const fs::path& path) {
  vtkNew<vtkPolyData> data;
  data->SetPoints(MakePoints(state.points));
  const auto count = static_cast<vtkIdType>(state.points.size());
  if (count > 1) {
    vtkNew<vtkCellArray> cells;
    cells->InsertNextCell(count);
    for (vtkIdType i = 0; i < count; ++i) cells->InsertCellPoint(i);
    data->SetLines(cells);
    for (std::size_t v = 0; v < line.values.size(); ++v) {
      data->GetCellData()->AddArray(MakeArray(line.values[v].name(), 1, std::vector<double>{state.values[v]}));
    }
  }
  WriteData<vtkXMLPolyDataWriter>(*data, path);
}

}  // namespace fascicle::client
