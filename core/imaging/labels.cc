#include "core/imaging/labels.h"

#include <set>
#include <sstream>

namespace fascicle {
namespace {

// 0 for infinite ones.
double Nearest(float value) { return std::isfinite(value) ? std::round(static_cast<double>(value)) : 0; }

bool IsWhole(float value) { return std::abs(static_cast<double>(value) - Nearest(value)) <= 1e-3; }

}  // namespace

std::string ExistingLabels(const VolumeImage& image) {
  constexpr std::size_t kTold = 20;
  std::set<double> labels;
  bool whole = true;
  for (const float value : image.values) {
    const double label = IsWhole(value) ? Nearest(value) : static_cast<double>(value);
    if (label != 0) labels.insert(label);
    whole &= IsWhole(value);
    if (labels.size() > kTold) break;
  }
  if (labels.empty()) return "all voxels are 0";
  std::ostringstream text;
  text << (labels.size() > kTold ? "some of the existing " : "existing ") << (whole ? "labels: " : "values: ");
  for (auto label = labels.begin(); label != labels.end(); ++label)
    text << (label == labels.begin() ? "" : ", ") << *label;
  if (!whole) text << "; they are no labels: select the body by a threshold";
  return text.str();
}

std::string NoteOnFractions(const VolumeImage& image) {
  std::size_t count = 0;
  float example = 0;
  for (const float value : image.values) {
    if (IsWhole(value)) continue;
    if (count++ == 0) example = value;
  }
  if (count == 0) return {};
  std::ostringstream text;
  text << count << " voxels have values that are no whole numbers, such as " << example << ": they have no label";
  return text.str();
}

std::string NoteOnSize(double length) {
  constexpr double kLargest = 3, kSmallest = 1e-4;  // [m]
  if (length >= kSmallest && length <= kLargest) return {};
  std::ostringstream text;
  text.precision(3);
  text << "the body is " << length * 1e3 << " mm long: is the unit of its file right?";
  return text.str();
}

}  // namespace fascicle
