// NIfTI headers [NIfTI-1 data format, nifti1.h; NIfTI-2, nifti2.h]. ITK's library ignores units of positions, reads no
// NIfTI-2, and refuses axes that are not at right angles without naming the cause.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <sstream>

#include "core/imaging/volume_layout.h"

namespace fascicle {
namespace {

// NiftiOffsets of the fields [byte]. NIfTI-2 has wider numbers.
struct NiftiOffsets {
  std::size_t dim, type, pixdim, voxels, slope, intercept, qform_code, sform_code, quaternion, offset, rows, units;
};
constexpr NiftiOffsets kFirst = {40, 70, 76, 108, 112, 116, 252, 254, 256, 268, 280, 123};
constexpr NiftiOffsets kSecond = {16, 12, 104, 168, 176, 184, 344, 348, 352, 376, 400, 500};
constexpr std::size_t kFirstSize = 348, kSecondSize = 540;

// Lengths and positions beyond these are errors [m].
constexpr double kLongest = 1e3, kShortest = 1e-9;

// The numbers of a header in either version and byte order.
class NiftiHeader {
 public:
  explicit NiftiHeader(std::string_view bytes) : bytes_(bytes) {
    if (bytes.size() < kFirstSize) return;
    for (const bool swapped : {false, true}) {
      swapped_ = swapped;
      const auto size = Raw<std::int32_t>(0);
      if (size == static_cast<std::int32_t>(kFirstSize)) {
        at_ = &kFirst;
        const std::string_view magic = bytes.substr(344, 4);
        paired_ = magic == std::string_view("ni1\0", 4);
        known_ = paired_ || magic == std::string_view("n+1\0", 4);
        return;
      }
      if (size == static_cast<std::int32_t>(kSecondSize) && bytes.size() >= kSecondSize) {
        at_ = &kSecond;
        const std::string_view magic = bytes.substr(4, 4);
        paired_ = magic == std::string_view("ni2\0", 4);
        known_ = paired_ || magic == std::string_view("n+2\0", 4);
        return;
      }
    }
  }

  bool ok() const { return at_ != nullptr && known_; }
  bool is_analyze() const { return at_ == &kFirst && !known_; }
  bool paired() const { return paired_; }
  bool big_endian() const { return swapped_ == (std::endian::native == std::endian::little); }
  bool second() const { return at_ == &kSecond; }
  std::size_t size() const { return second() ? kSecondSize : kFirstSize; }
  std::int64_t dim(std::size_t k) const {
    return second() ? Raw<std::int64_t>(at_->dim + 8 * k) : Raw<std::int16_t>(at_->dim + 2 * k);
  }
  int type() const { return Raw<std::int16_t>(at_->type); }
  double pixdim(std::size_t k) const { return Real(at_->pixdim, k); }
  double voxels() const {
    return second() ? static_cast<double>(Raw<std::int64_t>(at_->voxels)) : Real(at_->voxels, 0);
  }
  double slope() const { return Real(at_->slope, 0); }
  double intercept() const { return Real(at_->intercept, 0); }
  int qform_code() const { return Code(at_->qform_code); }
  int sform_code() const { return Code(at_->sform_code); }
  double quaternion(std::size_t k) const { return Real(at_->quaternion, k); }
  double offset(std::size_t k) const { return Real(at_->offset, k); }
  double row(std::size_t r, std::size_t column) const { return Real(at_->rows, 4 * r + column); }
  int units() const {
    return second() ? Raw<std::int32_t>(at_->units) : static_cast<unsigned char>(bytes_[at_->units]);
  }

 private:
  template <class T>
  T Raw(std::size_t at) const {
    char bytes[sizeof(T)];
    std::copy_n(bytes_.data() + at, sizeof(T), bytes);
    if (swapped_) std::reverse(bytes, bytes + sizeof(T));
    return std::bit_cast<T>(bytes);
  }
  double Real(std::size_t at, std::size_t k) const {
    return second() ? Raw<double>(at + 8 * k) : static_cast<double>(Raw<float>(at + 4 * k));
  }
  int Code(std::size_t at) const { return second() ? Raw<std::int32_t>(at) : Raw<std::int16_t>(at); }

  std::string_view bytes_;
  const NiftiOffsets* at_ = nullptr;
  bool swapped_ = false, paired_ = false, known_ = false;
};

// Voxel indices to positions [m], in NIfTI's frame: x right, y front, z head.
struct NiftiForm {
  Mat3 axes = Mat3::Identity();
  Vec3 origin = Vec3::Zero();
};

bool IsBounded(double value) { return std::abs(value) <= kLongest; }  // false for NaN

class NiftiReader {
 public:
  NiftiReader(std::string_view bytes, std::string_view pair, Problems& problems)
      : header_(bytes), pair_(pair), problems_(problems) {}

  std::optional<VolumeLayout> Read() {
    if (header_.is_analyze()) {
      Refuse("it is an image of Analyze 7.5, which does not say where the patient's right is", "save it as NIfTI");
      return std::nullopt;
    }
    if (!header_.ok()) {
      Refuse("it can't be read as a NIfTI image", "is it complete, and is it what its extension says?");
      return std::nullopt;
    }
    if (!TakeSize() || !TakeType() || !TakePlace() || !TakeVoxels()) return std::nullopt;
    return std::move(layout_);
  }

 private:
  bool Refuse(const std::string& message, const std::string& hint) {
    problems_.Add("", message, hint);
    return false;
  }
  void Note(const std::string& note) { layout_.image.notes.push_back(note); }

  bool TakeSize() {
    const std::int64_t count = header_.dim(0);
    if (count < 1 || count > 7)
      return Refuse("the image has " + std::to_string(count) + " dimensions", "is it complete?");
    std::vector<std::uint64_t> sizes;
    for (std::size_t axis = 1; axis <= static_cast<std::size_t>(count); ++axis) {
      // A length of 0 beyond the third dimension means none.
      const std::int64_t size = axis > 3 ? std::max<std::int64_t>(header_.dim(axis), 1) : header_.dim(axis);
      if (size < 0) return Refuse("the image has a size below 0", "is it complete?");
      sizes.push_back(static_cast<std::uint64_t>(size));
    }
    return TakeSizes(sizes, layout_, problems_);
  }

  bool TakeType() {
    const auto components = [&](int count) {
      return Refuse("the image has " + std::to_string(count) + " components a voxel",
                    "only one can be read: save one channel by itself");
    };
    const auto take = [&](VoxelType type) {
      layout_.type = type;
      return true;
    };
    switch (header_.type()) {
      case 2:
        return take(VoxelType::kUint8);
      case 4:
        return take(VoxelType::kInt16);
      case 8:
        return take(VoxelType::kInt32);
      case 16:
        return take(VoxelType::kFloat32);
      case 64:
        return take(VoxelType::kFloat64);
      case 256:
        return take(VoxelType::kInt8);
      case 512:
        return take(VoxelType::kUint16);
      case 768:
        return take(VoxelType::kUint32);
      case 1024:
        return take(VoxelType::kInt64);
      case 1280:
        return take(VoxelType::kUint64);
      case 32:
      case 1792:
      case 2048:
        return components(2);
      case 128:
        return components(3);
      case 2304:
        return components(4);
    }
    return Refuse("its numbers have the unknown type " + std::to_string(header_.type()),
                  "save them as 16-bit integers or floats");
  }

  double Unit() {
    switch (header_.units() & 7) {
      case 1:
        return 1;
      case 2:
        return 1e-3;
      case 3:
        return 1e-6;
    }
    Note("the header does not say the unit of lengths: millimetres are assumed");
    return 1e-3;
  }

  // All numbers on the place are finite and within bounds, whether they are used or not.
  bool IsSensible(double unit) const {
    bool ok = true;
    for (std::size_t axis = 1; axis <= 3; ++axis) {
      const double spacing = std::abs(header_.pixdim(axis)) * unit;
      ok &= spacing == 0 || (spacing >= kShortest && spacing <= kLongest);
    }
    for (std::size_t k = 0; k < 3; ++k) ok &= IsBounded(header_.quaternion(k)) && IsBounded(header_.offset(k) * unit);
    for (std::size_t column = 0; column < 4 && header_.sform_code() > 0; ++column) {
      double largest = 0;
      for (std::size_t row = 0; row < 3; ++row) {
        ok &= IsBounded(header_.row(row, column) * unit);
        largest = std::max(largest, std::abs(header_.row(row, column) * unit));
      }
      ok &= column == 3 || largest >= kShortest;
    }
    return ok;
  }

  Vec3 Pixdim(double unit) const {
    return unit * Vec3(std::abs(header_.pixdim(1)), std::abs(header_.pixdim(2)), std::abs(header_.pixdim(3)));
  }

  NiftiForm Sform(double unit) const {
    NiftiForm form;
    for (Eigen::Index r = 0; r < 3; ++r) {
      const auto row = static_cast<std::size_t>(r);
      for (Eigen::Index c = 0; c < 3; ++c) form.axes(r, c) = unit * header_.row(row, static_cast<std::size_t>(c));
      form.origin[r] = unit * header_.row(row, 3);
    }
    return form;
  }

  // [nifti1.h, method 2]
  NiftiForm Qform(double unit) const {
    double b = header_.quaternion(0), c = header_.quaternion(1), d = header_.quaternion(2), a = 0;
    const double rest = 1 - (b * b + c * c + d * d);
    if (rest < 1e-7) {
      const double norm = std::sqrt(b * b + c * c + d * d);
      b /= norm;
      c /= norm;
      d /= norm;
    } else {
      a = std::sqrt(rest);
    }
    NiftiForm form;
    form.axes << a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c),  //
        2 * (b * c + a * d), a * a + c * c - b * b - d * d, 2 * (c * d - a * b),           //
        2 * (b * d - a * c), 2 * (c * d + a * b), a * a + d * d - c * c - b * b;
    if (header_.pixdim(0) < 0) form.axes.col(2) = -form.axes.col(2);
    form.axes = form.axes * Pixdim(unit).asDiagonal();
    form.origin = unit * Vec3(header_.offset(0), header_.offset(1), header_.offset(2));
    return form;
  }

  // Largest distance between the places that two forms give to a corner of the image [m].
  double Difference(const NiftiForm& a, const NiftiForm& b) const {
    double largest = 0;
    for (int corner = 0; corner < 8; ++corner) {
      Vec3 index;
      for (int axis = 0; axis < 3; ++axis) {
        index[axis] =
            (corner >> axis & 1) != 0 ? static_cast<double>(layout_.size[static_cast<std::size_t>(axis)]) - 1 : 0;
      }
      largest = std::max(largest, ((a.axes - b.axes) * index + a.origin - b.origin).norm());
    }
    return largest;
  }

  // The scanner's own frame (code 1) comes first, and the sform before the qform.
  NiftiForm Choose(double unit) {
    const bool has_s = header_.sform_code() > 0, has_q = header_.qform_code() > 0;
    if (!has_s && !has_q) {
      NiftiForm form;
      form.axes = Pixdim(unit).asDiagonal();
      return form;
    }
    const bool takes_s = has_s && (!has_q || header_.sform_code() == 1 || header_.qform_code() != 1);
    const NiftiForm form = takes_s ? Sform(unit) : Qform(unit);
    if (has_s && has_q) {
      const NiftiForm other = takes_s ? Qform(unit) : Sform(unit);
      const double difference = Difference(form, other);
      // Far below a voxel they differ by their rounding only.
      if (difference > 0.1 * form.axes.colwise().norm().minCoeff()) {
        std::ostringstream note;
        note << "the sform (code " << header_.sform_code() << ") and the qform (code " << header_.qform_code()
             << ") differ by up to " << difference * 1e3 << " mm: the " << (takes_s ? "sform" : "qform") << " is taken";
        Note(note.str());
      }
    }
    const Vec3 lengths = form.axes.colwise().norm().transpose(), pixdim = Pixdim(unit);
    if (takes_s && pixdim.minCoeff() > 0 && ((lengths - pixdim).array().abs() > 1e-3 * pixdim.array()).any()) {
      std::ostringstream note;
      note << "pixdim says voxels of " << pixdim.transpose() * 1e3 << " mm, the sform " << lengths.transpose() * 1e3
           << " mm: the sform is taken";
      Note(note.str());
    }
    return form;
  }

  bool TakePlace() {
    const double unit = Unit();
    if (!IsSensible(unit)) {
      return Refuse(
          "the image's position has invalid numbers",
          "pixdim, quatern, qoffset and srow of its header must be finite, at most 1 km, and lengths above 1 nm");
    }
    if (layout_.size[2] == 1 && header_.dim(0) < 3) {
      Note("the image has two dimensions: its layer is as thick as pixdim[3] says");
    }
    NiftiForm form = Choose(unit);
    const Vec3 to_lps(-1, -1, 1);
    TakeAxes(to_lps.asDiagonal() * form.axes, layout_);
    layout_.image.origin = to_lps.cwiseProduct(form.origin);
    // An axis without length has no direction: CheckPlace reports its spacing.
    if (!layout_.image.direction.allFinite()) layout_.image.direction = Mat3::Identity();
    return true;
  }

  bool TakeVoxels() {
    layout_.big_endian = header_.big_endian();
    layout_.packing = Packing::kAsMarked;
    layout_.replaces_non_finite = true;
    // A slope of 0 means that there is none.
    const double slope = header_.slope(), intercept = header_.intercept();
    if (std::isfinite(slope) && slope != 0) {
      layout_.slope = slope;
      layout_.intercept = std::isfinite(intercept) ? intercept : 0;
    }
    // Without extensions, some programs leave the offset of the voxels at 0.
    const double least = header_.paired() ? 0 : static_cast<double>(header_.size());
    const double given = header_.voxels(), voxels = given == 0 && !header_.paired() ? least + 4 : given;
    if (!(voxels >= least && voxels < 1e12)) {
      return Refuse("the header says that its voxels start at byte " + std::to_string(given), "is it complete?");
    }
    layout_.skip = static_cast<std::int64_t>(voxels);
    if (header_.paired() == pair_.empty()) {
      return Refuse(header_.paired() ? "it is the header of a pair of files" : "it is no header of a pair of files",
                    "a pair is named .hdr and .img, a single file .nii");
    }
    if (header_.paired()) layout_.files.emplace_back(pair_);
    return true;
  }

  NiftiHeader header_;
  std::string_view pair_;
  Problems& problems_;
  VolumeLayout layout_;
};

}  // namespace

std::optional<VolumeLayout> ReadNiftiHeader(std::string_view bytes, std::string_view pair, Problems& problems) {
  return NiftiReader(bytes, pair, problems).Read();
}

}  // namespace fascicle
