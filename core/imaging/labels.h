#ifndef FASCICLE_CORE_IMAGING_LABELS_H_
#define FASCICLE_CORE_IMAGING_LABELS_H_

#include <cmath>
#include <string>

#include "core/imaging/volume_image.h"

namespace fascicle {

// Labels are whole numbers, but programs store them with scales and in floats. A value within 1e-3 of a whole number is
// that number.
inline bool HasLabel(float value, int label) { return std::abs(static_cast<double>(value) - label) <= 1e-3; }

// A hint for a label that no voxel has: the labels that there are.
std::string ExistingLabels(const VolumeImage& image);
// A note if values of an image of labels are no whole numbers; otherwise empty.
std::string NoteOnFractions(const VolumeImage& image);
// A note if a body with edges up to `length` [m] is above 3 m or below 0.1 mm, as by a wrong unit; otherwise empty.
std::string NoteOnSize(double length);

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_LABELS_H_
