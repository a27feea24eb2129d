// VTK XML unstructured grids (.vtu) and surfaces (.vtp) ["VTK file formats", VTK User's Guide].
#include <algorithm>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/stop.h"
#include "core/geometry/byte_array.h"
#include "core/geometry/mesh_readers.h"
#include "core/geometry/surface_readers.h"
#include "core/geometry/text_scanner.h"
#include "core/geometry/vtk_cells.h"
#include "core/geometry/vtu_data.h"

namespace fascicle {
namespace {

constexpr std::int64_t kMaxCount = std::int64_t{1} << 40;

std::optional<NumberType> VtuTypeNamed(std::string_view name) {
  if (name == "Int8") return NumberType::kInt8;
  if (name == "UInt8") return NumberType::kUInt8;
  if (name == "Int16") return NumberType::kInt16;
  if (name == "UInt16") return NumberType::kUInt16;
  if (name == "Int32") return NumberType::kInt32;
  if (name == "UInt32") return NumberType::kUInt32;
  if (name == "Int64") return NumberType::kInt64;
  if (name == "UInt64") return NumberType::kUInt64;
  if (name == "Float32") return NumberType::kFloat32;
  if (name == "Float64") return NumberType::kFloat64;
  return std::nullopt;
}

// The file without its appended section (which is not valid XML when raw), and the section's data.
struct VtuParts {
  std::string xml;
  std::string_view appended;  // without the leading underscore
  bool base64 = false;
  bool complete = true;
};

VtuParts Split(std::string_view bytes) {
  VtuParts parts;
  const std::size_t tag = bytes.find("<AppendedData");
  if (tag == std::string_view::npos) {
    parts.xml = bytes;
    return parts;
  }
  const std::size_t data = bytes.find('_', tag), end = bytes.rfind("</AppendedData>");
  const std::size_t close = bytes.find('>', tag);
  if (close == std::string_view::npos || data == std::string_view::npos || close > data ||
      end == std::string_view::npos || end < data) {
    parts.complete = false;
    return parts;
  }
  parts.base64 = bytes.substr(tag, close - tag).find("base64") != std::string_view::npos;
  parts.appended = bytes.substr(data + 1, end - data - 1);
  parts.xml.assign(bytes.substr(0, tag));
  parts.xml += "</VTKFile>";
  return parts;
}

class VtuReader {
 public:
  VtuReader(std::string_view bytes, const std::stop_token& stop, Problems& problems)
      : problems_(problems), stop_(stop), size_(bytes.size()), parts_(Split(bytes)) {}

  // `type` is UnstructuredGrid or PolyData.
  RawMesh Read(const std::string& type) {
    if (!parts_.complete) {
      Fail("the appended data is not complete", "is the file complete?");
      return {};
    }
    pugi::xml_document document;
    const pugi::xml_parse_result result = document.load_buffer(parts_.xml.data(), parts_.xml.size());
    if (!result) {
      const auto end = parts_.xml.begin() + std::min<std::ptrdiff_t>(result.offset, std::ptrdiff_t(parts_.xml.size()));
      Fail("line " + std::to_string(1 + std::count(parts_.xml.begin(), end, '\n')) + ": " + result.description(),
           "is the file complete?");
      return {};
    }
    const pugi::xml_node file = document.child("VTKFile");
    if (!file || file.attribute("type").value() != type) {
      Fail("the file is not a VTKFile of type " + type,
           type == "PolyData" ? "write the surface as poly data" : "write the mesh as an unstructured grid");
      return {};
    }
    if (ReadEncoding(file)) {
      for (const pugi::xml_node piece : file.child(type.c_str()).children("Piece")) {
        if (!(type == "PolyData" ? ReadSurfacePiece(piece) : ReadPiece(piece))) break;
      }
    }
    return std::move(raw_);
  }

  // The polygons of a surface file.
  std::vector<std::vector<std::int64_t>> TakePolygons() { return std::move(polygons_); }

 private:
  bool Fail(std::string message, std::string hint = {}) {
    problems_.Add("", std::move(message), std::move(hint));
    return false;
  }

  bool ReadEncoding(pugi::xml_node file) {
    VtuEncoding encoding;
    const std::string_view order = file.attribute("byte_order").as_string("LittleEndian");
    const std::string_view word = file.attribute("header_type").as_string("UInt32");
    const std::string_view compressor = file.attribute("compressor").value();
    encoding.big_endian = big_endian_ = order == "BigEndian";
    encoding.header_word = word == "UInt64" ? 8 : 4;
    encoding.compressed = !compressor.empty();
    decoder_.emplace(encoding, size_);
    if (!big_endian_ && order != "LittleEndian") return Fail("unknown byte_order " + Quoted(order));
    if (word != "UInt64" && word != "UInt32") return Fail("unknown header_type " + Quoted(word));
    if (encoding.compressed && compressor != "vtkZLibDataCompressor") {
      return Fail("the data is compressed by " + Quoted(compressor),
                  "write it with vtkZLibDataCompressor or uncompressed");
    }
    return true;
  }

  bool ReadPiece(pugi::xml_node piece) {
    std::int64_t points = 0, cells = 0;
    if (!ReadCount(piece, "NumberOfPoints", points) || !ReadCount(piece, "NumberOfCells", cells)) return false;
    std::vector<double> coordinates;
    VtkCells list;
    const pugi::xml_node cell_node = piece.child("Cells");
    if (!ReadDoubles(piece.child("Points").child("DataArray"), "Points", 3 * points, coordinates) ||
        !ReadInts(Named(cell_node, "types"), "types", cells, list.types) ||
        !ReadInts(Named(cell_node, "offsets"), "offsets", cells, list.ends) ||
        !ReadInts(Named(cell_node, "connectivity"), "connectivity", list.ends.empty() ? 0 : list.ends.back(),
                  list.connectivity)) {
      return false;
    }
    for (const pugi::xml_node array : piece.child("CellData").children("DataArray")) {
      const char* name = array.attribute("Name").value();
      if (!IsTagArray(name) || array.attribute("NumberOfComponents").as_int(1) != 1) continue;
      if (!ReadInts(array, name, cells, list.tags)) return false;
      break;
    }
    const std::string wrong = AddCells(list, points, std::int64_t(raw_.nodes.size()), raw_);
    if (!wrong.empty()) return Fail(wrong);
    for (std::int64_t n = 0; n < points; ++n) raw_.nodes.emplace_back(coordinates.data() + 3 * n);
    return true;
  }

  bool ReadSurfacePiece(pugi::xml_node piece) {
    std::int64_t points = 0, polygons = 0, strips = 0;
    if (!ReadCount(piece, "NumberOfPoints", points) || !ReadCount(piece, "NumberOfPolys", polygons)) return false;
    if (piece.attribute("NumberOfStrips") && !ReadCount(piece, "NumberOfStrips", strips)) return false;
    if (strips > 0) return Fail("the surface is made of strips", "write it as triangles");
    std::vector<double> coordinates;
    std::vector<std::int64_t> ends, nodes;
    const pugi::xml_node cells = piece.child("Polys");
    if (!ReadDoubles(piece.child("Points").child("DataArray"), "Points", 3 * points, coordinates) ||
        !ReadInts(Named(cells, "offsets"), "offsets", polygons, ends) ||
        !ReadInts(Named(cells, "connectivity"), "connectivity", ends.empty() ? 0 : ends.back(), nodes)) {
      return false;
    }
    const auto first = std::int64_t(raw_.nodes.size());
    std::int64_t begin = 0;
    for (const std::int64_t end : ends) {
      if (end < begin || end > std::int64_t(nodes.size())) return Fail("the offsets of the polygons do not ascend");
      auto& polygon = polygons_.emplace_back();
      for (; begin < end; ++begin) {
        const bool exists = nodes[begin] >= 0 && nodes[begin] < points;
        polygon.push_back(exists ? first + nodes[begin] : -1);
      }
    }
    for (std::int64_t n = 0; n < points; ++n) raw_.nodes.emplace_back(coordinates.data() + 3 * n);
    return true;
  }

  bool ReadCount(pugi::xml_node piece, const char* name, std::int64_t& count) {
    const std::string_view text = piece.attribute(name).value();
    if (ParseInt(text, count) && count >= 0 && count < kMaxCount) return true;
    return Fail(std::string(name) + " is " + Quoted(text) + ", not a valid count");
  }

  static pugi::xml_node Named(pugi::xml_node parent, const char* name) {
    return parent.find_child_by_attribute("DataArray", "Name", name);
  }

  bool ReadDoubles(pugi::xml_node array, const std::string& name, std::int64_t count, std::vector<double>& values) {
    std::string bytes;
    NumberType type;
    bool ascii = false;
    if (!ReadData(array, name, count, type, bytes, ascii)) return false;
    if (ascii) return ReadAscii(array, name, count, values);
    values = ToDoubles(bytes, type, big_endian_);
    return true;
  }

  bool ReadInts(pugi::xml_node array, const std::string& name, std::int64_t count, std::vector<std::int64_t>& values) {
    std::string bytes;
    NumberType type;
    bool ascii = false;
    if (!ReadData(array, name, count, type, bytes, ascii)) return false;
    if (!ascii) {
      values = ToInts(bytes, type, big_endian_);
      return true;
    }
    if (type != NumberType::kFloat32 && type != NumberType::kFloat64) return ReadAscii(array, name, count, values);
    std::vector<double> numbers;
    if (!ReadAscii(array, name, count, numbers)) return false;
    values = WholeNumbers(numbers);
    return true;
  }

  // The bytes of a binary array, exactly `count` numbers. For an ascii array only its attributes are read.
  bool ReadData(pugi::xml_node array, const std::string& name, std::int64_t count, NumberType& type, std::string& bytes,
                bool& ascii) {
    ThrowIfStopped(stop_);
    if (!array) return Fail("the array " + Quoted(name) + " is missing", "is the file complete?");
    const std::string_view type_name = array.attribute("type").value();
    const std::string_view format = array.attribute("format").as_string("ascii");
    const std::optional<NumberType> named = VtuTypeNamed(type_name);
    if (!named) return Fail("the array " + Quoted(name) + " has the type " + Quoted(type_name));
    type = *named;
    ascii = format == "ascii";
    if (ascii) return true;
    std::optional<std::string> data;
    if (format == "binary") {
      data = decoder_->Decode(array.child_value(), true);
    } else if (format == "appended") {
      std::int64_t offset = 0;
      if (!ParseInt(array.attribute("offset").value(), offset) || offset < 0 ||
          offset > std::int64_t(parts_.appended.size())) {
        return Fail("the array " + Quoted(name) + " begins beyond the appended data", "is the file complete?");
      }
      data = decoder_->Decode(parts_.appended.substr(std::size_t(offset)), parts_.base64);
    } else {
      return Fail("the array " + Quoted(name) + " has the format " + Quoted(format));
    }
    if (!data) return Fail("the array " + Quoted(name) + " " + decoder_->problem(), "is the file complete?");
    if (data->size() != std::size_t(count) * SizeOf(type)) {
      return Fail("the array " + Quoted(name) + " has " + std::to_string(data->size()) + " bytes where " +
                  std::to_string(count) + " numbers should be");
    }
    bytes = std::move(*data);
    return true;
  }

  template <class Number>
  bool ReadAscii(pugi::xml_node array, const std::string& name, std::int64_t count, std::vector<Number>& values) {
    Problems in_array;
    TextScanner in(array.child_value(), in_array, '\0', stop_);
    if (in.Holds(count, "numbers", 2)) {
      values.reserve(std::size_t(count));
      for (std::int64_t i = 0; i < count && !in.failed(); ++i) {
        if constexpr (std::is_same_v<Number, double>) {
          values.push_back(in.Double("a number"));
        } else {
          values.push_back(in.Int("a whole number"));
        }
      }
    }
    if (!in.failed() && !in.AtEnd()) in.Fail("more than " + std::to_string(count) + " numbers");
    for (const Problem& problem : in_array.kept())
      Fail("the array " + Quoted(name) + ", " + problem.message, problem.hint);
    return !in.failed();
  }

  Problems& problems_;
  const std::stop_token& stop_;
  std::size_t size_;
  VtuParts parts_;
  std::optional<VtuDecoder> decoder_;
  bool big_endian_ = false;
  RawMesh raw_;
  std::vector<std::vector<std::int64_t>> polygons_;
};

}  // namespace

RawMesh ReadVtu(std::string_view bytes, const std::stop_token& stop, Problems& problems) {
  return VtuReader(bytes, stop, problems).Read("UnstructuredGrid");
}

RawSurface ReadVtp(std::string_view bytes, const std::stop_token& stop, Problems& problems) {
  VtuReader reader(bytes, stop, problems);
  RawSurface raw;
  raw.nodes = reader.Read("PolyData").nodes;
  raw.polygons = reader.TakePolygons();
  return raw;
}

}  // namespace fascicle
