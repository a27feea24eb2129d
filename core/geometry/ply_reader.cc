// PLY, ASCII and binary [Turk 1994, "The PLY Polygon File Format", Stanford].
#include <array>
#include <optional>
#include <string>
#include <utility>

#include "core/geometry/byte_array.h"
#include "core/geometry/surface_readers.h"
#include "core/geometry/text_scanner.h"

namespace fascicle {
namespace {

std::optional<NumberType> PlyTypeNamed(std::string_view name) {
  if (name == "char" || name == "int8") return NumberType::kInt8;
  if (name == "uchar" || name == "uint8") return NumberType::kUInt8;
  if (name == "short" || name == "int16") return NumberType::kInt16;
  if (name == "ushort" || name == "uint16") return NumberType::kUInt16;
  if (name == "int" || name == "int32") return NumberType::kInt32;
  if (name == "uint" || name == "uint32") return NumberType::kUInt32;
  if (name == "float" || name == "float32") return NumberType::kFloat32;
  if (name == "double" || name == "float64") return NumberType::kFloat64;
  return std::nullopt;
}

struct Property {
  std::string_view name;
  NumberType type = NumberType::kFloat32;
  std::optional<NumberType> count_type;  // of a list
};

struct Element {
  std::string_view name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

class PlyReader {
 public:
  PlyReader(std::string_view bytes, const std::stop_token& stop, Problems& problems)
      : in_(bytes, problems, '\0', stop) {}

  RawSurface Read() {
    ReadHeader();
    for (const Element& element : elements_) {
      // Each element takes at least a byte, unless it has no properties.
      if (!element.properties.empty() && !in_.Holds(static_cast<std::int64_t>(element.count), element.name, 1)) break;
      for (std::size_t i = 0; i < element.count && !element.properties.empty() && !in_.failed(); ++i) {
        ReadElement(element);
      }
    }
    return std::move(raw_);
  }

 private:
  NumberType Type(std::string_view name) {
    const std::optional<NumberType> type = PlyTypeNamed(name);
    if (!type) in_.Fail("a property has the type " + Quoted(name));
    return type.value_or(NumberType::kInt8);
  }

  void ReadHeader() {
    in_.Expect("ply");
    in_.Expect("format");
    const std::string_view format = in_.Token();
    binary_ = format != "ascii";
    big_endian_ = format == "binary_big_endian";
    if (!in_.failed() && binary_ && !big_endian_ && format != "binary_little_endian") {
      in_.Fail("the format is " + Quoted(format), "known are ascii, binary_little_endian and binary_big_endian");
    }
    in_.Line();
    for (std::string_view keyword = in_.Token(); !in_.failed() && keyword != "end_header"; keyword = in_.Token()) {
      ReadHeaderLine(keyword);
    }
    in_.Line();
  }

  void ReadHeaderLine(std::string_view keyword) {
    if (keyword == "element") {
      const std::string_view name = in_.Token();
      elements_.push_back({name, in_.Count("elements", 1), {}});
    } else if (keyword == "property" && !elements_.empty()) {
      Property property;
      std::string_view type = in_.Token();
      if (type == "list") {
        property.count_type = Type(in_.Token());
        type = in_.Token();
      }
      property.type = Type(type);
      property.name = in_.Token();
      elements_.back().properties.push_back(property);
    } else if (keyword == "comment" || keyword == "obj_info") {
      in_.Line();
    } else {
      in_.Fail("expected `element`, `property` or `end_header` but found " + Quoted(keyword), "is the file complete?");
    }
  }

  double Number(NumberType type) {
    if (!binary_) return in_.Double("a number");
    const std::string_view bytes = in_.Bytes(SizeOf(type), "bytes of a number");
    return in_.failed() ? 0 : ToDoubles(bytes, type, big_endian_)[0];
  }

  void ReadElement(const Element& element) {
    Vec3 node = Vec3::Zero();
    for (const Property& property : element.properties) {
      if (property.count_type) {
        ReadList(element, property);
        continue;
      }
      const double value = Number(property.type);
      if (property.name == "x") node.x() = value;
      if (property.name == "y") node.y() = value;
      if (property.name == "z") node.z() = value;
    }
    if (element.name == "vertex") raw_.nodes.push_back(node);
  }

  void ReadList(const Element& element, const Property& property) {
    const double count = Number(*property.count_type);
    if (in_.failed()) return;
    if (!(count >= 0 && count <= static_cast<double>(in_.remaining()))) {
      in_.Fail("a list of " + std::to_string(count) + " numbers", "is the file complete?");
      return;
    }
    const bool face = element.name == "face" && (property.name == "vertex_indices" || property.name == "vertex_index");
    std::vector<std::int64_t> polygon;
    for (int i = 0; i < static_cast<int>(count) && !in_.failed(); ++i) {
      const double value = Number(property.type);
      // A value that is not an integer becomes an invalid node.
      if (face) polygon.push_back(WholeNumbers({value})[0]);
    }
    if (face) raw_.polygons.push_back(std::move(polygon));
  }

  TextScanner in_;
  bool binary_ = false, big_endian_ = false;
  std::vector<Element> elements_;
  RawSurface raw_;
};

}  // namespace

RawSurface ReadPly(std::string_view bytes, const std::stop_token& stop, Problems& problems) {
  return PlyReader(bytes, stop, problems).Read();
}

}  // namespace fascicle
