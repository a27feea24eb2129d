#ifndef FASCICLE_CORE_IMAGING_ITK_IMPORT_H_
#define FASCICLE_CORE_IMAGING_ITK_IMPORT_H_

#include <itkImportImageFilter.h>

#include <vector>

#include "core/geometry/voxel_grid.h"

namespace fascicle {

// An ITK image that refers to numbers owned by the caller and does not write to them. Filters ignore its axes and
// origin. Internal to this room.
template <class T>
typename itk::ImportImageFilter<T, 3>::Pointer Import(const std::vector<T>& values, const GridIndex& size,
                                                      const Vec3& spacing) {
  auto import = itk::ImportImageFilter<T, 3>::New();
  typename itk::ImportImageFilter<T, 3>::SizeType lengths;
  for (unsigned axis = 0; axis < 3; ++axis) lengths[axis] = size[axis];
  import->SetRegion(itk::ImageRegion<3>(lengths));
  import->SetSpacing(spacing.data());
  import->SetImportPointer(const_cast<T*>(values.data()), values.size(), false);
  return import;
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_ITK_IMPORT_H_
