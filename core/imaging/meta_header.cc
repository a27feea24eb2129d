// MetaImage headers [MetaIO documentation, Kitware]. ITK's library takes a missing size of the compressed data, further
// dimensions and failures of its own for zeros, without an error.
#include <map>
#include <string>

#include "core/base/letters.h"
#include "core/imaging/volume_files.h"
#include "core/imaging/volume_layout.h"

namespace fascicle {
namespace {

const std::map<std::string, VoxelType, std::less<>>& MetaTypes() {
  // A LONG has four bytes in this format, on any machine.
  static const std::map<std::string, VoxelType, std::less<>> types = {
      {"MET_CHAR", VoxelType::kInt8},     {"MET_UCHAR", VoxelType::kUint8},    {"MET_SHORT", VoxelType::kInt16},
      {"MET_USHORT", VoxelType::kUint16}, {"MET_INT", VoxelType::kInt32},      {"MET_UINT", VoxelType::kUint32},
      {"MET_LONG", VoxelType::kInt32},    {"MET_ULONG", VoxelType::kUint32},   {"MET_LONG_LONG", VoxelType::kInt64},
      {"MET_FLOAT", VoxelType::kFloat32}, {"MET_DOUBLE", VoxelType::kFloat64}, {"MET_ULONG_LONG", VoxelType::kUint64}};
  return types;
}

// The fields by their names in lower case. Lines without `=` and empty lines say nothing.
class MetaFields {
 public:
  // Reads up to the field ElementDataFile, which is the last; false if there is none.
  bool Read(std::string_view& text) {
    while (const std::optional<std::string_view> line = TakeLine(text)) {
      const std::size_t equals = line->find('=');
      if (equals == std::string_view::npos) continue;
      const std::string key = Lower(Trimmed(line->substr(0, equals)));
      fields_[key] = Trimmed(line->substr(equals + 1));
      if (key == "elementdatafile") return true;
    }
    return false;
  }

  // The value of the first of these fields that is given; empty if none is.
  std::string_view Value(std::initializer_list<const char*> keys) const {
    for (const char* key : keys) {
      const auto found = fields_.find(key);
      if (found != fields_.end()) return found->second;
    }
    return {};
  }
  bool IsTrue(std::initializer_list<const char*> keys) const {
    const std::string_view value = Value(keys);
    return !value.empty() && (value[0] == 'T' || value[0] == 't' || value[0] == '1');
  }

 private:
  std::map<std::string, std::string_view, std::less<>> fields_;
};

class MetaHeader {
 public:
  explicit MetaHeader(Problems& problems) : problems_(problems) {}

  std::optional<VolumeLayout> Read(std::string_view bytes) {
    std::string_view rest = bytes;
    if (!fields_.Read(rest) || fields_.Value({"ndims"}).empty()) {
      Refuse("the file has no header of a MetaImage image", "is it complete, and is it what its extension says?");
      return std::nullopt;
    }
    layout_.start = static_cast<std::int64_t>(bytes.size() - rest.size());
    if (!TakeSize() || !TakeType() || !TakePlace() || !TakeStorage(rest)) return std::nullopt;
    return std::move(layout_);
  }

 private:
  bool Refuse(const std::string& message, const std::string& hint) {
    problems_.Add("", message, hint);
    return false;
  }
  static std::string Quoted(std::string_view text) { return "`" + std::string(text.substr(0, 60)) + "`"; }

  bool TakeSize() {
    const std::string_view given = fields_.Value({"ndims"});
    if (given != "2" && given != "3" && given != "4") {
      return Refuse("the image has " + Quoted(given) + " dimensions", "only three can be read");
    }
    dimensions_ = static_cast<std::size_t>(given[0] - '0');
    const auto sizes = ParseCounts(fields_.Value({"dimsize"}));
    if (!sizes || sizes->size() != dimensions_) {
      return Refuse("DimSize is " + Quoted(fields_.Value({"dimsize"})),
                    "it must be a number of voxels for each of NDims");
    }
    return TakeSizes(*sizes, layout_, problems_);
  }

  bool TakeType() {
    const std::string_view channels = fields_.Value({"elementnumberofchannels"});
    if (!channels.empty() && channels != "1") {
      return Refuse("the image has " + std::string(channels.substr(0, 20)) + " components a voxel",
                    "only one can be read: save one channel by itself");
    }
    const std::string_view name = fields_.Value({"elementtype"});
    const auto found = MetaTypes().find(name);
    if (found == MetaTypes().end()) {
      return Refuse("the type of its numbers is " + Quoted(name), "ElementType must be one of MET_UCHAR to MET_DOUBLE");
    }
    layout_.type = found->second;
    const auto slope = Numbers({"elementtointensityfunctionslope"}, 1, {1});
    const auto intercept = Numbers({"elementtointensityfunctionoffset"}, 1, {0});
    if (!slope || !intercept) return false;
    layout_.slope = (*slope)[0];
    layout_.intercept = (*intercept)[0];
    return true;
  }

  // Numbers of a field, at least `count`; the default if it is absent.
  std::optional<std::vector<double>> Numbers(std::initializer_list<const char*> keys, std::size_t count,
                                             std::vector<double> absent) {
    const std::string_view value = fields_.Value(keys);
    if (value.empty()) return absent;
    auto numbers = ParseNumbers(value);
    if (numbers && numbers->size() >= count) return numbers;
    Refuse(std::string(*keys.begin()) + " is " + Quoted(value), std::to_string(count) + " numbers are needed");
    return std::nullopt;
  }

  std::optional<double> Unit() {
    const std::string unit = Lower(fields_.Value({"distanceunits"}));
    if (unit.empty() || unit == "?" || unit == "mm") return kMillimetre;
    if (unit == "um") return 1e-6;
    if (unit == "cm") return 1e-2;
    Refuse("the unit of its lengths is " + Quoted(unit), "DistanceUnits must be um, mm or cm");
    return std::nullopt;
  }

  bool TakePlace() {
    const std::size_t n = dimensions_;
    std::vector<double> identity(n * n, 0);
    for (std::size_t axis = 0; axis < n; ++axis) identity[axis * n + axis] = 1;
    const std::optional<double> unit = Unit();
    const auto spacing = Numbers({"elementspacing", "elementsize"}, n, std::vector<double>(n, 1));
    const auto origin = Numbers({"offset", "origin", "position"}, n, std::vector<double>(n, 0));
    const auto axes = Numbers({"transformmatrix", "rotation", "orientation"}, n * n, identity);
    if (!unit || !spacing || !origin || !axes) return false;
    VolumeImage& image = layout_.image;
    if (fields_.Value({"elementspacing", "elementsize"}).empty()) {
      image.notes.push_back("the header has no ElementSpacing: voxels of 1 mm are assumed");
    }
    if (n == 2)
      image.notes.push_back("the image has two dimensions: its layer is taken as thick as the voxels are along i");
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<Eigen::Index>(axis);
      image.spacing[a] = (axis < n ? (*spacing)[axis] : (*spacing)[0]) * *unit;
      image.origin[a] = axis < n ? (*origin)[axis] * *unit : 0;
      for (std::size_t row = 0; row < 3; ++row) {
        image.direction(static_cast<Eigen::Index>(row), a) =
            axis < n && row < n ? (*axes)[axis * n + row] : (axis == row ? 1 : 0);
      }
    }
    return true;
  }

  bool TakeStorage(std::string_view rest) {
    layout_.big_endian = fields_.IsTrue({"binarydatabyteordermsb", "elementbyteordermsb"});
    const std::string_view binary = fields_.Value({"binarydata"});
    if (!binary.empty() && !fields_.IsTrue({"binarydata"})) layout_.coding = Coding::kDecimal;
    if (fields_.IsTrue({"compresseddata"})) layout_.packing = Packing::kDeflate;
    const std::string_view file = fields_.Value({"elementdatafile"});
    if (Lower(file) == "local") return true;
    // Bytes before the voxels of a data file.
    const auto header = Numbers({"headersize"}, 1, {0});
    if (!header) return false;
    const double bytes = (*header)[0];
    if (!(bytes >= -1 && bytes <= 1e15)) return Refuse("HeaderSize is out of range", "it is a number of bytes, or -1");
    layout_.start = bytes < 0 ? 0 : static_cast<std::int64_t>(bytes);
    layout_.skip = bytes < 0 ? -1 : 0;
    return TakeDataFiles(file, rest, layout_, problems_);
  }

  Problems& problems_;
  MetaFields fields_;
  VolumeLayout layout_;
  std::size_t dimensions_ = 3;
};

}  // namespace

std::optional<VolumeLayout> ReadMetaHeader(std::string_view bytes, Problems& problems) {
  return MetaHeader(problems).Read(bytes);
}

}  // namespace fascicle
