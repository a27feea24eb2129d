#include "core/imaging/nifti_check.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace fascicle {
namespace {

// In millimetres, for lengths and positions.
constexpr float kLargest = 1e6F, kSmallest = 1e-6F;

// The numbers of a header in either byte order [NIfTI-1 data format, nifti1.h].
class NiftiHeader {
 public:
  explicit NiftiHeader(std::string_view bytes) : bytes_(bytes) { swapped_ = !IsDimension(Number<std::int16_t>(40)); }

  // The byte order is the one for which dim[0] is valid, as the format defines it.
  bool ok() const { return IsDimension(Number<std::int16_t>(40)); }
  float spacing(int axis) const { return Number<float>(80 + 4 * axis); }
  bool has_matrix() const { return Number<std::int16_t>(254) > 0; }
  float matrix(int row, int column) const { return Number<float>(280 + 16 * row + 4 * column); }
  // quatern_b to qoffset_z.
  float quaternion_or_offset(int k) const { return Number<float>(256 + 4 * k); }

 private:
  static bool IsDimension(int count) { return count >= 1 && count <= 7; }

  template <class T>
  T Number(std::size_t at) const {
    char bytes[sizeof(T)];
    std::copy_n(bytes_.data() + at, sizeof(T), bytes);
    if (swapped_) std::reverse(bytes, bytes + sizeof(T));
    return std::bit_cast<T>(bytes);
  }

  std::string_view bytes_;
  bool swapped_ = false;
};

bool IsBounded(float value) { return std::abs(value) <= kLargest; }  // false for NaN

bool CheckMatrix(const NiftiHeader& header) {
  for (int column = 0; column < 4; ++column) {
    float largest = 0;
    for (int row = 0; row < 3; ++row) {
      if (!IsBounded(header.matrix(row, column))) return false;
      largest = std::max(largest, std::abs(header.matrix(row, column)));
    }
    if (column < 3 && largest < kSmallest) return false;
  }
  return true;
}

}  // namespace

bool CheckNiftiPlace(std::string_view bytes, Problems& problems) {
  if (bytes.size() < kNiftiHeader) return true;
  const NiftiHeader header(bytes);
  if (!header.ok()) return true;
  bool ok = true;
  for (int axis = 0; axis < 3; ++axis) {
    // By convention 0 stands for 1.
    const float spacing = std::abs(header.spacing(axis));
    ok &= spacing == 0 || (spacing >= kSmallest && spacing <= kLargest);
  }
  for (int k = 0; k < 6; ++k) ok &= IsBounded(header.quaternion_or_offset(k));
  if (header.has_matrix()) ok &= CheckMatrix(header);
  if (!ok) {
    problems.Add(
        "", "the image's position has invalid numbers",
        "pixdim, quatern, qoffset and srow of its header must be finite, at most 10^6, and lengths above 10^-6 mm");
  }
  return ok;
}

}  // namespace fascicle
