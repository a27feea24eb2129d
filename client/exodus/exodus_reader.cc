// Exodus II [Schoof and Yarberry 1994, "EXODUS II: A finite element data model", SAND92-2137], by VTK's reader.
#include "client/exodus/exodus_reader.h"

#include <vtkCompositeDataSet.h>
#include <vtkDataArray.h>
#include <vtkExodusIIReader.h>
#include <vtkInformation.h>
#include <vtkLogger.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkNew.h>
#include <vtkOutputWindow.h>
#include <vtkPointData.h>
#include <vtkSmartPointer.h>
#include <vtkStringOutputWindow.h>
#include <vtkUnstructuredGrid.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/letters.h"
#include "core/base/stop.h"
#include "core/geometry/mesh_readers.h"
#include "core/geometry/text_scanner.h"
#include "core/geometry/vtk_cells.h"

namespace fascicle::client {
namespace {

// A kind of part of the file: the name of its group in VTK's output, and that of parts without a name.
struct Group {
  std::string_view name;
  vtkExodusIIReader::ObjectType type;
  int dimension;
  const char* part;
};
constexpr std::array<Group, 3> kGroups = {{{"Element Blocks", vtkExodusIIReader::ELEM_BLOCK, 3, "block"},
                                           {"Side Sets", vtkExodusIIReader::SIDE_SET, 2, "side_set"},
                                           {"Node Sets", vtkExodusIIReader::NODE_SET, 0, "node_set"}}};

class Collector {
 public:
  explicit Collector(const std::stop_token& stop) : stop_(stop) {}

  // Adds a part with a tag of its own. Returns what is wrong, or an empty string.
  std::string Add(const Group& group, const std::string& name, vtkUnstructuredGrid& grid) {
    const std::vector<std::int64_t> numbers = AddNodes(grid);
    if (numbers.empty()) return {};
    const auto tag = static_cast<std::int32_t>(raw_.names.size() + 1);
    raw_.names.push_back({group.dimension, tag, name});
    if (group.type == vtkExodusIIReader::NODE_SET) {
      for (const std::int64_t number : numbers) {
        raw_.points.push_back({number});
        raw_.point_tags.push_back(tag);
      }
      return {};
    }
    VtkCells cells;
    for (vtkIdType c = 0; c < grid.GetNumberOfCells(); ++c) {
      ThrowIfStopped(stop_);
      vtkIdType size = 0;
      const vtkIdType* nodes = nullptr;
      grid.GetCellPoints(c, size, nodes);
      for (vtkIdType n = 0; n < size; ++n) cells.connectivity.push_back(numbers[static_cast<std::size_t>(nodes[n])]);
      cells.types.push_back(grid.GetCellType(c));
      cells.ends.push_back(static_cast<std::int64_t>(cells.connectivity.size()));
      cells.tags.push_back(tag);
    }
    return AddCells(cells, 1 + *std::max_element(numbers.begin(), numbers.end()), 0, raw_);
  }

  RawMesh Take() {
    for (const auto& [number, position] : positions_) {
      raw_.node_numbers.push_back(number);
      raw_.nodes.push_back(position);
    }
    return std::move(raw_);
  }

 private:
  // The file's numbers of the part's nodes.
  std::vector<std::int64_t> AddNodes(vtkUnstructuredGrid& grid) {
    std::vector<std::int64_t> numbers;
    vtkDataArray* ids = grid.GetPointData()->GetArray(vtkExodusIIReader::GetImplicitNodeIdArrayName());
    for (vtkIdType n = 0; ids != nullptr && n < grid.GetNumberOfPoints(); ++n) {
      ThrowIfStopped(stop_);
      numbers.push_back(static_cast<std::int64_t>(ids->GetComponent(n, 0)));
      positions_[numbers.back()] = Vec3(grid.GetPoint(n));
    }
    return numbers;
  }

  const std::stop_token& stop_;
  RawMesh raw_;
  std::map<std::int64_t, Vec3> positions_;
};

// Keeps VTK from printing what it says of a file, which is checked afterwards.
class QuietVtk {
 public:
  QuietVtk() : before_(vtkOutputWindow::GetInstance()) {
    vtkNew<vtkStringOutputWindow> quiet;
    vtkOutputWindow::SetInstance(quiet);
    vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
  }
  ~QuietVtk() {
    vtkLogger::SetStderrVerbosity(verbosity_);
    vtkOutputWindow::SetInstance(before_);
  }
  QuietVtk(const QuietVtk&) = delete;
  QuietVtk& operator=(const QuietVtk&) = delete;

 private:
  vtkSmartPointer<vtkOutputWindow> before_;
  vtkLogger::Verbosity verbosity_ = vtkLogger::GetCurrentVerbosityCutoff();
};

// Whether the file begins like NetCDF, in which Exodus is stored: classic, or HDF5.
bool IsNetcdf(const std::filesystem::path& path) {
  std::array<char, 4> start = {};
  std::ifstream(path, std::ios::binary).read(start.data(), start.size());
  const std::string_view text(start.data(), start.size());
  return text.starts_with("CDF") || text == "\x89HDF";
}

vtkMultiBlockDataSet* GroupNamed(vtkMultiBlockDataSet& all, std::string_view name) {
  for (unsigned b = 0; b < all.GetNumberOfBlocks(); ++b) {
    if (!all.HasMetaData(b)) continue;
    const char* found = all.GetMetaData(b)->Get(vtkCompositeDataSet::NAME());
    if (found != nullptr && name == found) return vtkMultiBlockDataSet::SafeDownCast(all.GetBlock(b));
  }
  return nullptr;
}

// Adds the parts of a group. VTK leaves out those that it can't read, so their sizes are compared with the file's.
void ReadGroup(const Group& group, vtkExodusIIReader& reader, Collector& collector, Problems& problems) {
  vtkMultiBlockDataSet* parts = GroupNamed(*reader.GetOutput(), group.name);
  for (int p = 0; p < reader.GetNumberOfObjects(group.type); ++p) {
    const auto block = static_cast<unsigned>(p);
    const bool is_there = parts != nullptr && block < parts->GetNumberOfBlocks();
    auto* grid = is_there ? vtkUnstructuredGrid::SafeDownCast(parts->GetBlock(block)) : nullptr;
    std::string name = reader.GetObjectName(group.type, p);
    if (name.starts_with("Unnamed")) {
      name = group.part + ("_" + std::to_string(reader.GetObjectId(group.type, p)));
    }
    const vtkIdType size = grid == nullptr                             ? 0
                           : group.type == vtkExodusIIReader::NODE_SET ? grid->GetNumberOfPoints()
                                                                       : grid->GetNumberOfCells();
    if (size != reader.GetNumberOfEntriesInObject(group.type, p)) {
      problems.Add("", Quoted(name) + " can't be read", "is the file complete?");
    } else if (size > 0) {
      const std::string wrong = collector.Add(group, name, *grid);
      if (!wrong.empty()) problems.Add("", Quoted(name) + ": " + wrong);
    }
  }
}

}  // namespace

bool IsExodusName(const std::string& name) {
  const std::string extension = LowerExtension(name);
  constexpr std::array<std::string_view, 6> kExtensions = {".e", ".exo", ".ex2", ".exii", ".g", ".gen"};
  return std::find(kExtensions.begin(), kExtensions.end(), extension) != kExtensions.end();
}

std::optional<TetMesh> ReadExodus(const std::filesystem::path& path, bool split_solids, Problems& problems,
                                  const std::stop_token& stop, MeshRemarks& remarks) {
  const QuietVtk quiet;
  vtkNew<vtkExodusIIReader> reader;
  const bool can_read = IsNetcdf(path) && reader->CanReadFile(path.c_str()) != 0;
  if (can_read) {
    reader->SetFileName(path.c_str());
    reader->UpdateInformation();
    reader->SetApplyDisplacements(0);
    reader->SetGenerateImplicitNodeIdArray(1);
    for (const Group& group : kGroups) {
      for (int i = 0; i < reader->GetNumberOfObjects(group.type); ++i) reader->SetObjectStatus(group.type, i, 1);
    }
    reader->Update();
  }
  ThrowIfStopped(stop);
  if (!can_read || reader->GetOutput() == nullptr) {
    problems.Add("", "the file can't be read", "is it complete, and is it Exodus II?");
    return std::nullopt;
  }
  const std::size_t before = problems.count();
  Collector collector(stop);
  for (const Group& group : kGroups) ReadGroup(group, *reader, collector, problems);
  if (problems.count() > before) return std::nullopt;
  return FinishMesh(collector.Take(), split_solids ? Solids::kSplit : Solids::kKeep, problems, stop, &remarks);
}

}  // namespace fascicle::client
