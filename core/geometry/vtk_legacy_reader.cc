// VTK legacy unstructured grids, ASCII and binary, versions 1 to 5 ["VTK file formats", VTK User's Guide].
#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/letters.h"
#include "core/geometry/byte_array.h"
#include "core/geometry/mesh_readers.h"
#include "core/geometry/text_scanner.h"
#include "core/geometry/vtk_cells.h"

namespace fascicle {
namespace {

constexpr std::size_t kMaxComponents = 1000;

std::optional<NumberType> LegacyTypeNamed(std::string_view token) {
  const std::string name = Lower(token);
  if (name == "char" || name == "signed_char") return NumberType::kInt8;
  if (name == "unsigned_char") return NumberType::kUInt8;
  if (name == "short") return NumberType::kInt16;
  if (name == "unsigned_short") return NumberType::kUInt16;
  // VTK writes its identifiers with 32 bits here.
  if (name == "int" || name == "vtkidtype") return NumberType::kInt32;
  if (name == "unsigned_int") return NumberType::kUInt32;
  if (name == "long" || name == "vtktypeint64") return NumberType::kInt64;
  if (name == "unsigned_long" || name == "vtktypeuint64") return NumberType::kUInt64;
  if (name == "float") return NumberType::kFloat32;
  if (name == "double") return NumberType::kFloat64;
  return std::nullopt;
}

class LegacyReader {
 public:
  LegacyReader(std::string_view bytes, const std::stop_token& stop, Problems& problems)
      : in_(bytes, problems, '\0', stop) {}

  RawMesh Read() {
    ReadHeader();
    while (!in_.failed() && !in_.AtEnd()) ReadSection();
    if (in_.failed()) return std::move(raw_);
    if (cells_.types.empty()) {
      in_.Fail("the file has no cells", "is the file complete?");
    } else if (const std::string wrong = AddCells(cells_, std::int64_t(raw_.nodes.size()), 0, raw_); !wrong.empty()) {
      in_.Fail(wrong);
    }
    return std::move(raw_);
  }

 private:
  void ReadHeader() {
    constexpr std::string_view kFirst = "# vtk DataFile Version ";
    const std::string_view first = in_.Line();
    double version = 0;
    if (!first.starts_with(kFirst) || !ParseDouble(first.substr(kFirst.size(), 3), version)) {
      return in_.Fail("the file does not begin with `# vtk DataFile Version` and a number");
    }
    begins_and_nodes_ = version >= 5;
    in_.Line();  // title
    const std::string format = Lower(in_.Token());
    binary_ = format == "binary";
    if (!binary_ && format != "ascii") return in_.Fail("expected ASCII or BINARY but found " + Quoted(format));
    in_.Expect("DATASET");
    const std::string_view dataset = in_.Token();
    if (!in_.failed() && dataset != "UNSTRUCTURED_GRID") {
      in_.Fail("the data set is " + Quoted(dataset), "write it as UNSTRUCTURED_GRID with tetrahedra");
    }
  }

  void ReadSection() {
    const std::string keyword = Lower(in_.Token());
    if (keyword == "points") {
      ReadPoints();
    } else if (keyword == "cells") {
      ReadCells();
    } else if (keyword == "cell_types") {
      const std::size_t count = in_.Count("cell types", BytesEach(NumberType::kInt32));
      cells_.types = Ints(count, NumberType::kInt32);
    } else if (keyword == "cell_data" || keyword == "point_data") {
      // Each attribute takes at least a byte. The sections below have counts of their own.
      attribute_count_ = in_.Count("attributes", 1);
      of_cells_ = keyword == "cell_data";
      if (!in_.failed() && of_cells_ && attribute_count_ != cells_.types.size()) {
        in_.Fail("data of " + std::to_string(attribute_count_) + " cells, where there are " +
                 std::to_string(cells_.types.size()));
      }
    } else if (keyword == "metadata") {
      SkipMetadata();
    } else {
      ReadAttribute(keyword);
    }
  }

  void ReadPoints() {
    if (!raw_.nodes.empty()) return in_.Fail("a second section POINTS");
    const std::size_t count = in_.Count("points", 6);
    const std::optional<NumberType> type = Type();
    if (in_.failed() || !in_.Holds(std::int64_t(count), "points", 3 * BytesEach(*type))) return;
    const std::vector<double> values = Doubles(3 * count, *type);
    if (in_.failed()) return;
    raw_.nodes.resize(count);
    for (std::size_t n = 0; n < count; ++n) raw_.nodes[n] = Vec3(values[3 * n], values[3 * n + 1], values[3 * n + 2]);
  }

  // Up to version 4: `CELLS n size`, then n times a node count and the nodes. From version 5 on: `CELLS n+1 size`, then
  // two arrays: offsets and connectivity.
  void ReadCells() {
    if (!cells_.connectivity.empty()) return in_.Fail("a second section CELLS");
    const std::size_t count = in_.Count("cells", 1);
    const std::size_t size = in_.Count("cell nodes", BytesEach(NumberType::kInt8));
    if (in_.failed()) return;
    if (begins_and_nodes_) return ReadOffsets(count, size);
    const std::vector<std::int64_t> list = Ints(size, NumberType::kInt32);
    for (std::size_t at = 0, cell = 0; cell < count; ++cell) {
      if (in_.failed()) return;
      if (at >= list.size() || list[at] < 0 || list[at] >= std::int64_t(list.size() - at)) {
        return in_.Fail("cell " + std::to_string(cell) + " reaches beyond the list of cells");
      }
      const std::size_t end = at + 1 + std::size_t(list[at]);
      cells_.connectivity.insert(cells_.connectivity.end(), list.begin() + at + 1, list.begin() + end);
      cells_.ends.push_back(std::int64_t(cells_.connectivity.size()));
      at = end;
    }
  }

  void ReadOffsets(std::size_t count, std::size_t size) {
    if (Lower(in_.Token()) != "offsets") return in_.Fail("expected OFFSETS");
    const std::optional<NumberType> offset_type = Type();
    if (in_.failed()) return;
    cells_.ends = Ints(count, *offset_type);
    if (!in_.failed() && Lower(in_.Token()) != "connectivity") in_.Fail("expected CONNECTIVITY");
    const std::optional<NumberType> type = Type();
    if (in_.failed()) return;
    cells_.connectivity = Ints(size, *type);
    if (in_.failed() || cells_.ends.empty()) return;
    if (cells_.ends.front() != 0) return in_.Fail("the first cell does not begin at 0");
    cells_.ends.erase(cells_.ends.begin());
  }

  void ReadAttribute(const std::string& keyword) {
    if (keyword == "field") {
      in_.Token();  // name
      const std::size_t arrays = in_.Count("arrays", 6);
      for (std::size_t a = 0; a < arrays && !in_.failed(); ++a) ReadFieldArray();
    } else if (attribute_count_ == kNone) {
      in_.Fail("unknown section " + Quoted(keyword));
    } else if (keyword == "scalars") {
      const std::string name(in_.Token());
      const std::string type(in_.Token());
      std::int64_t components = 1;
      if (ParseInt(in_.Peek(), components)) in_.Token();
      if (Lower(in_.Token()) != "lookup_table") in_.Fail("expected LOOKUP_TABLE");
      in_.Token();
      ReadArray(name, type, components, attribute_count_);
    } else if (keyword == "lookup_table") {
      in_.Token();  // name
      // Four values per colour: bytes, or numbers from 0 to 1 in ASCII.
      ReadArray("", binary_ ? "unsigned_char" : "float", 4, in_.Count("colours", 4));
    } else if (keyword == "color_scalars") {
      const std::string name(in_.Token());
      const std::int64_t components = in_.Int("the number of components");
      ReadArray(name, binary_ ? "unsigned_char" : "float", components, attribute_count_);
    } else if (keyword == "texture_coordinates") {
      const std::string name(in_.Token());
      const std::int64_t components = in_.Int("the number of components");
      ReadArray(name, in_.Token(), components, attribute_count_);
    } else if (keyword == "vectors" || keyword == "normals" || keyword == "tensors" || keyword == "tensors6" ||
               keyword == "global_ids" || keyword == "pedigree_ids") {
      const int components = keyword == "tensors" ? 9 : keyword == "tensors6" ? 6 : keyword.ends_with("ids") ? 1 : 3;
      const std::string name(in_.Token());
      ReadArray(name, in_.Token(), components, attribute_count_);
    } else {
      in_.Fail("unknown section " + Quoted(keyword));
    }
  }

  void ReadFieldArray() {
    if (Lower(in_.Peek()) == "metadata") {
      in_.Token();
      SkipMetadata();
    }
    const std::string name(in_.Token());
    const std::int64_t components = in_.Int("the number of components");
    const std::size_t tuples = in_.Count("tuples", 1);
    ReadArray(name, in_.Token(), components, tuples);
  }

  void ReadArray(std::string_view name, std::string_view type_name, std::int64_t components, std::size_t tuples) {
    if (in_.failed()) return;
    const std::optional<NumberType> type = LegacyTypeNamed(type_name);
    if (!type) {
      return in_.Fail("the array " + Quoted(name) + " has the type " + Quoted(type_name), "leave the array out");
    }
    if (components < 1 || components > std::int64_t(kMaxComponents)) {
      return in_.Fail("the array " + Quoted(name) + " has " + std::to_string(components) + " components");
    }
    const std::size_t count = tuples * std::size_t(components);
    if (of_cells_ && components == 1 && tuples == cells_.types.size() && IsTagArray(name)) {
      cells_.tags = Ints(count, *type);
    } else {
      Doubles(count, *type);
    }
  }

  // The metadata ends with an empty line.
  void SkipMetadata() {
    in_.Line();
    while (in_.remaining() > 0) {
      const std::string_view line = in_.Line();
      if (line.find_first_not_of(" \t") == std::string_view::npos) return;
    }
  }

  std::optional<NumberType> Type() {
    const std::string_view name = in_.Token();
    const std::optional<NumberType> type = LegacyTypeNamed(name);
    if (!type && !in_.failed()) in_.Fail("unknown type of numbers " + Quoted(name));
    return type;
  }

  // Least size of a number in the file.
  std::size_t BytesEach(NumberType type) const { return binary_ ? SizeOf(type) : 2; }

  std::string_view Raw(std::size_t count, NumberType type) {
    in_.Line();  // the rest of the header line
    if (!in_.Holds(std::int64_t(count), "numbers", SizeOf(type))) return {};
    return in_.Bytes(count * SizeOf(type), "bytes");
  }

  std::vector<double> Doubles(std::size_t count, NumberType type) {
    if (binary_) return ToDoubles(Raw(count, type), type, true);
    if (!in_.Holds(std::int64_t(count), "numbers", 2)) return {};
    std::vector<double> values(count);
    for (std::size_t i = 0; i < count && !in_.failed(); ++i) values[i] = in_.Double("a number");
    return values;
  }

  std::vector<std::int64_t> Ints(std::size_t count, NumberType type) {
    if (binary_) return ToInts(Raw(count, type), type, true);
    if (type == NumberType::kFloat32 || type == NumberType::kFloat64) return WholeNumbers(Doubles(count, type));
    if (!in_.Holds(std::int64_t(count), "numbers", 2)) return {};
    std::vector<std::int64_t> values(count);
    for (std::size_t i = 0; i < count && !in_.failed(); ++i) values[i] = in_.Int("a whole number");
    return values;
  }

  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  TextScanner in_;
  RawMesh raw_;
  VtkCells cells_;
  bool binary_ = false;
  bool begins_and_nodes_ = false;  // the layout of CELLS since version 5
  bool of_cells_ = false;
  std::size_t attribute_count_ = kNone;
};

}  // namespace

RawMesh ReadVtkLegacy(std::string_view bytes, const std::stop_token& stop, Problems& problems) {
  return LegacyReader(bytes, stop, problems).Read();
}

}  // namespace fascicle
