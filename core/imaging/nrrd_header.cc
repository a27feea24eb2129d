// NRRD headers [Definition of NRRD file format, teem.sourceforge.net/nrrd/format.html; section numbers below]. ITK's
// library ignores units, turns left-anterior-superior images by half a turn, and refuses long lines and bzip2.
#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "core/base/letters.h"
#include "core/imaging/volume_files.h"
#include "core/imaging/volume_layout.h"

namespace fascicle {
namespace {

const std::map<std::string, VoxelType, std::less<>>& NrrdTypes() {
  static const std::map<std::string, VoxelType, std::less<>> types = [] {
    std::map<std::string, VoxelType, std::less<>> all = {{"float", VoxelType::kFloat32},
                                                         {"double", VoxelType::kFloat64}};
    const auto add = [&all](VoxelType type, std::initializer_list<const char*> names) {
      for (const char* name : names) all[name] = type;
    };
    add(VoxelType::kInt8, {"signed char", "int8", "int8_t"});
    add(VoxelType::kUint8, {"uchar", "unsigned char", "uint8", "uint8_t"});
    add(VoxelType::kInt16, {"short", "short int", "signed short", "signed short int", "int16", "int16_t"});
    add(VoxelType::kUint16, {"ushort", "unsigned short", "unsigned short int", "uint16", "uint16_t"});
    add(VoxelType::kInt32, {"int", "signed int", "int32", "int32_t"});
    add(VoxelType::kUint32, {"uint", "unsigned int", "uint32", "uint32_t"});
    add(VoxelType::kInt64,
        {"longlong", "long long", "long long int", "signed long long", "signed long long int", "int64", "int64_t"});
    add(VoxelType::kUint64, {"ulonglong", "unsigned long long", "unsigned long long int", "uint64", "uint64_t"});
    return all;
  }();
  return types;
}

// A unit of length [m]; nothing if it is not known.
std::optional<double> MetresIn(std::string_view unit) {
  static const std::map<std::string, double, std::less<>> units = [] {
    std::map<std::string, double, std::less<>> all = {{"", kMillimetre}};
    const auto add = [&all](double metres, std::initializer_list<const char*> names) {
      for (const char* name : names) all[name] = metres;
    };
    add(1, {"m", "meter", "meters", "metre", "metres"});
    add(1e-2, {"cm", "centimeter", "centimeters", "centimetre", "centimetres"});
    add(kMillimetre, {"mm", "millimeter", "millimeters", "millimetre", "millimetres"});
    add(1e-6, {"um", "\xc2\xb5m", "\xce\xbcm", "micron", "microns", "micrometer", "micrometers", "micrometre",
               "micrometres"});
    add(1e-9, {"nm", "nanometer", "nanometers", "nanometre", "nanometres"});
    return all;
  }();
  const auto found = units.find(Lower(unit));
  return found == units.end() ? std::nullopt : std::optional<double>(found->second);
}

// Signs that turn positions of a space to DICOM's left-posterior-superior; nothing for unknown spaces.
std::optional<Vec3> SignsOf(std::string_view space) {
  const std::string lower = Lower(space);
  if (lower == "left-posterior-superior" || lower == "lps") return Vec3(1, 1, 1);
  if (lower == "right-anterior-superior" || lower == "ras") return Vec3(-1, -1, 1);
  if (lower == "left-anterior-superior" || lower == "las") return Vec3(1, -1, 1);
  return std::nullopt;
}

class NrrdHeader {
 public:
  explicit NrrdHeader(Problems& problems) : problems_(problems) {}

  std::optional<VolumeLayout> Read(std::string_view bytes) {
    std::string_view rest = bytes;
    if (!TakeFields(rest) || Value("dimension").empty()) {
      Refuse("the file has no header of a NRRD image", "is it complete, and is it what its extension says?");
      return std::nullopt;
    }
    if (layout_.files.empty()) layout_.start = static_cast<std::int64_t>(bytes.size() - rest.size());
    if (!problems_.empty() || !TakeSize() || !TakeType() || !TakePlace() || !TakeStorage(bytes)) return std::nullopt;
    return std::move(layout_);
  }

 private:
  bool Refuse(const std::string& message, const std::string& hint) {
    problems_.Add("", message, hint);
    return false;
  }
  static std::string Quoted(std::string_view text) { return "`" + std::string(text.substr(0, 60)) + "`"; }

  std::string_view Value(std::string_view key) const {
    const auto found = fields_.find(key);
    return found == fields_.end() ? std::string_view() : found->second;
  }

  // Reads lines `field: value` up to an empty line; a detached header may also end with the file (2.1). Comments and
  // lines `key:=value` are not about the voxels.
  bool TakeFields(std::string_view& text) {
    const std::optional<std::string_view> magic = TakeLine(text);
    if (!magic || !magic->starts_with("NRRD000")) return false;
    while (const std::optional<std::string_view> line = TakeLine(text)) {
      if (Trimmed(*line).empty()) return true;
      const std::size_t colon = line->find(':');
      if (line->starts_with('#') || colon == std::string_view::npos || line->substr(colon).starts_with(":=")) continue;
      const std::string key = Lower(Trimmed(line->substr(0, colon)));
      const std::string_view value = Trimmed(line->substr(colon + 1));
      if (key == "data file" || key == "datafile") {
        // A list of files takes the rest of the header (5.1).
        if (!TakeDataFiles(value, text, layout_, problems_)) return true;
        if (value.starts_with("LIST")) return true;
      }
      fields_[key] = value;
    }
    return !layout_.files.empty();
  }

  bool TakeSize() {
    const auto dimension = ParseCounts(Value("dimension"));
    const auto sizes = ParseCounts(Value("sizes"));
    if (!dimension || dimension->size() != 1 || !sizes || sizes->size() != (*dimension)[0] || sizes->size() < 2) {
      return Refuse("its sizes are " + Quoted(Value("sizes")), "a number of voxels for each dimension is needed");
    }
    sizes_ = *sizes;
    if (!TakeVectors()) return false;
    std::vector<std::uint64_t> spatial;
    for (std::size_t axis = 0; axis < sizes_.size(); ++axis) {
      if (IsSpatial(axis)) {
        spatial.push_back(sizes_[axis]);
        axes_.push_back(axis);
      } else if (sizes_[axis] != 1) {
        return Refuse("the image has " + std::to_string(sizes_[axis]) + " components a voxel",
                      "only one can be read: save one channel, or one layer of a segmentation, by itself");
      }
    }
    if (axes_.size() < 2) return Refuse("the image has no axes in space", "space directions or kinds must name them");
    if (!TakeSizes(spatial, layout_, problems_)) return false;
    axes_.resize(std::min<std::size_t>(axes_.size(), 3));
    return true;
  }

  // An axis lies in space if it has a direction; without directions, if its kind does not say otherwise.
  bool IsSpatial(std::size_t axis) const {
    if (!vectors_.empty()) return vectors_[axis].has_value();
    std::string_view kinds = Value("kinds");
    std::string kind;
    for (std::size_t k = 0; k <= axis; ++k) {
      kinds = Trimmed(kinds);
      const std::size_t end = std::min(kinds.find_first_of(" \t"), kinds.size());
      kind = Lower(kinds.substr(0, end));
      kinds.remove_prefix(end);
    }
    return kind.empty() || kind == "domain" || kind == "space" || kind == "time" || kind == "???" || kind == "none";
  }

  // Vectors such as "(1,0,0)", or nothing for "none".
  static std::optional<std::vector<std::optional<Vec3>>> ParseVectors(std::string_view text) {
    std::vector<std::optional<Vec3>> vectors;
    for (text = Trimmed(text); !text.empty(); text = Trimmed(text)) {
      if (text.starts_with("none")) {
        vectors.emplace_back();
        text.remove_prefix(4);
        continue;
      }
      const std::size_t end = text.find(')');
      if (text[0] != '(' || end == std::string_view::npos) return std::nullopt;
      std::string inside(text.substr(1, end - 1));
      for (char& c : inside) c = c == ',' ? ' ' : c;
      const auto numbers = ParseNumbers(inside);
      if (!numbers || numbers->size() != 3) return std::nullopt;
      vectors.emplace_back(Vec3((*numbers)[0], (*numbers)[1], (*numbers)[2]));
      text.remove_prefix(end + 1);
    }
    return vectors;
  }

  bool TakeVectors() {
    if (Value("space directions").empty()) return true;
    const auto vectors = ParseVectors(Value("space directions"));
    if (!vectors || vectors->size() != sizes_.size()) {
      return Refuse("the space directions are " + Quoted(Value("space directions")),
                    "a vector of three numbers, or `none`, is needed for each dimension");
    }
    vectors_ = *vectors;
    return true;
  }

  bool TakeType() {
    const auto found = NrrdTypes().find(Lower(Value("type")));
    if (found == NrrdTypes().end())
      return Refuse("the type of its numbers is " + Quoted(Value("type")), "is it an image?");
    layout_.type = found->second;
    return true;
  }

  // The unit that `field` gives for the axes in space [m].
  std::optional<double> Unit(const char* field, bool of_all_axes) {
    std::vector<double> units;
    std::string_view text = Value(field);
    while (text.find('"') != std::string_view::npos) {
      text.remove_prefix(text.find('"') + 1);
      const std::size_t end = std::min(text.find('"'), text.size());
      const std::optional<double> metres = MetresIn(Trimmed(text.substr(0, end)));
      const std::size_t axis = units.size();
      const bool matters = !of_all_axes || std::find(axes_.begin(), axes_.end(), axis) != axes_.end();
      if (!metres && matters) {
        Refuse(std::string("the ") + field + " are " + Quoted(Value(field)), "mm, cm, m, um or nm can be read");
        return std::nullopt;
      }
      units.push_back(matters ? *metres : 0);
      text.remove_prefix(std::min(end + 1, text.size()));
    }
    std::erase(units, 0.0);
    for (const double unit : units) {
      if (unit == units[0]) continue;
      Refuse(std::string("the ") + field + " differ between axes: " + Quoted(Value(field)), "save it with one unit");
      return std::nullopt;
    }
    return units.empty() ? kMillimetre : units[0];
  }

  bool TakePlace() {
    if (axes_.size() == 2) {
      layout_.image.notes.push_back(
          "the image has two dimensions: its layer is taken as thick as the voxels are along i");
    }
    return vectors_.empty() ? TakeSpacings() : TakeDirections();
  }

  bool TakeDirections() {
    const std::optional<Vec3> signs = Signs();
    const std::optional<double> unit = Unit("space units", false);
    if (!signs || !unit) return false;
    Mat3 axes;
    for (std::size_t a = 0; a < axes_.size(); ++a) axes.col(static_cast<Eigen::Index>(a)) = *vectors_[axes_[a]];
    if (axes_.size() == 2) axes.col(2) = axes.col(0).cross(axes.col(1)).normalized() * axes.col(0).norm();
    TakeAxes(signs->asDiagonal() * axes * *unit, layout_);
    const std::string_view origin = Value("space origin");
    if (origin.empty() || origin == "none") return true;
    const auto vectors = ParseVectors(origin);
    if (!vectors || vectors->size() != 1 || !(*vectors)[0]) {
      return Refuse("the space origin is " + Quoted(origin), "one vector of three numbers is needed");
    }
    layout_.image.origin = signs->cwiseProduct(*(*vectors)[0]) * *unit;
    return true;
  }

  std::optional<Vec3> Signs() {
    const std::string_view space = Value("space");
    const std::string lower = Lower(space);
    if (const std::optional<Vec3> signs = SignsOf(space)) return signs;
    const bool of_scanner = lower == "scanner-xyz" || lower == "3d-right-handed" || lower == "3d-left-handed";
    if (of_scanner || space.empty()) {
      const std::string says = space.empty() ? "the header names no space" : "its space is " + std::string(space);
      layout_.image.notes.push_back(says + ": positions are taken as left, posterior, superior");
      return Vec3(1, 1, 1);
    }
    Refuse("its space is " + Quoted(space), "left-posterior-superior, right-anterior-superior, left-anterior-superior");
    return std::nullopt;
  }

  bool TakeSpacings() {
    const std::optional<double> unit = Unit("units", true);
    const auto spacings =
        Value("spacings").empty() ? std::vector<double>(sizes_.size(), 1) : ParseNumbers(Value("spacings"));
    const auto lowest =
        Value("axis mins").empty() ? std::vector<double>(sizes_.size(), 0) : ParseNumbers(Value("axis mins"));
    if (!unit) return false;
    if (!spacings || spacings->size() != sizes_.size() || !lowest || lowest->size() != sizes_.size()) {
      return Refuse("the spacings are " + Quoted(Value("spacings")), "a number for each dimension is needed");
    }
    if (Value("spacings").empty())
      layout_.image.notes.push_back("the header has no spacings: voxels of 1 mm are assumed");
    const bool cells = Lower(Value("centers").empty() ? Value("centerings") : Value("centers")).starts_with("cell");
    for (std::size_t a = 0; a < 3; ++a) {
      const std::size_t axis = axes_[std::min(a, axes_.size() - 1)];
      const auto row = static_cast<Eigen::Index>(a);
      layout_.image.spacing[row] = (a < axes_.size() ? (*spacings)[axis] : (*spacings)[axes_[0]]) * *unit;
      const double half = cells && !Value("axis mins").empty() ? 0.5 * layout_.image.spacing[row] : 0;
      const double least = (*lowest)[axis];
      layout_.image.origin[row] = a < axes_.size() && std::isfinite(least) ? least * *unit + half : 0;
    }
    return true;
  }

  bool TakeStorage(std::string_view bytes) {
    const std::string encoding = Lower(Value("encoding"));
    if (encoding == "gzip" || encoding == "gz") {
      layout_.packing = Packing::kDeflate;
    } else if (encoding == "bzip2" || encoding == "bz2") {
      layout_.packing = Packing::kBzip2;
    } else if (encoding == "hex") {
      layout_.coding = Coding::kHexadecimal;
    } else if (encoding == "ascii" || encoding == "text" || encoding == "txt") {
      layout_.coding = Coding::kDecimal;
    } else if (encoding != "raw" && !encoding.empty()) {
      return Refuse("its encoding is " + Quoted(encoding), "raw, gzip, bzip2, hex and ascii can be read");
    }
    const std::string endian = Lower(Value("endian"));
    layout_.big_endian = endian == "big";
    if (endian.empty() && layout_.coding != Coding::kDecimal && BytesOf(layout_.type) > 1) {
      return Refuse("the header does not say the order of bytes", "it needs a line `endian: little` or `endian: big`");
    }
    return TakeSkips(bytes);
  }

  // Lines are skipped before, bytes after unpacking (5.2).
  bool TakeSkips(std::string_view bytes) {
    const auto bytes_skipped = Value("byte skip").empty() ? std::vector<double>{0} : ParseNumbers(Value("byte skip"));
    const auto lines = Value("line skip").empty() ? std::vector<std::uint64_t>{0} : ParseCounts(Value("line skip"));
    constexpr double kMost = 1e15;
    if (!bytes_skipped || bytes_skipped->size() != 1 || !((*bytes_skipped)[0] >= -1 && (*bytes_skipped)[0] < kMost)) {
      return Refuse("byte skip is " + Quoted(Value("byte skip")), "it is a number of bytes, or -1");
    }
    layout_.skip = static_cast<std::int64_t>((*bytes_skipped)[0]);
    if (!lines || lines->size() != 1 || ((*lines)[0] > 0 && !layout_.files.empty())) {
      return Refuse("line skip is " + Quoted(Value("line skip")), "write the header and its voxels to one file");
    }
    for (std::uint64_t n = 0; n < (*lines)[0]; ++n) {
      std::string_view rest =
          bytes.substr(std::min<std::size_t>(static_cast<std::size_t>(layout_.start), bytes.size()));
      const std::size_t before = rest.size();
      if (!TakeLine(rest)) return Refuse("line skip is beyond the end of the file", "is the file complete?");
      layout_.start += static_cast<std::int64_t>(before - rest.size());
    }
    return true;
  }

  Problems& problems_;
  std::map<std::string, std::string_view, std::less<>> fields_;
  std::vector<std::uint64_t> sizes_;
  std::vector<std::optional<Vec3>> vectors_;  // of each dimension; empty without space directions
  std::vector<std::size_t> axes_;             // the dimensions in space
  VolumeLayout layout_;
};

}  // namespace

std::optional<VolumeLayout> ReadNrrdHeader(std::string_view bytes, Problems& problems) {
  return NrrdHeader(problems).Read(bytes);
}

}  // namespace fascicle
