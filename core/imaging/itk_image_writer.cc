#include "core/imaging/itk_image_writer.h"

#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>
#include <limits>
#include <utility>
#include <vector>

#include "core/base/check.h"
#include "core/imaging/voxel_types.h"

namespace fascicle {
namespace {

using itk::ImageIOBase;
using Component = itk::CommonEnums::IOComponent;

// Silences the library, which prints errors that are reported here anyway.
void Silence() {
  [[maybe_unused]] static const bool once = [] {
    itk::Object::GlobalWarningDisplayOff();
    return true;
  }();
}

ImageIOBase::Pointer MakeIo(VolumeFormat format) {
  Silence();
  switch (format) {
    case VolumeFormat::kMetaImage:
      return itk::MetaImageIO::New().GetPointer();
    case VolumeFormat::kNrrd:
      return itk::NrrdImageIO::New().GetPointer();
    case VolumeFormat::kNifti:
      return itk::NiftiImageIO::New().GetPointer();
    case VolumeFormat::kDicom:
    case VolumeFormat::kRaw:
      break;
  }
  FASCICLE_CHECK(false, "neither series nor raw files are written");
}

template <class T>
void ConvertTo(const std::vector<float>& values, std::vector<char>& bytes) {
  bytes.resize(values.size() * sizeof(T));
  for (std::size_t i = 0; i < values.size(); ++i) {
    T value;
    if constexpr (std::is_floating_point_v<T>) {
      value = values[i];
    } else {
      const double rounded = std::nearbyint(static_cast<double>(values[i]));
      value = static_cast<T>(std::clamp(rounded, static_cast<double>(std::numeric_limits<T>::min()),
                                        static_cast<double>(std::numeric_limits<T>::max())));
    }
    std::memcpy(bytes.data() + i * sizeof(T), &value, sizeof(T));
  }
}

Component ComponentOf(VoxelType type) {
  constexpr Component kComponents[] = {Component::UCHAR,    Component::CHAR,     Component::USHORT, Component::SHORT,
                                       Component::UINT,     Component::INT,      Component::FLOAT,  Component::DOUBLE,
                                       Component::LONGLONG, Component::ULONGLONG};
  return kComponents[static_cast<int>(type)];
}

}  // namespace

bool WriteByItk(const VolumeImage& image, VoxelType type, VolumeFormat format, const std::filesystem::path& path) {
  const ImageIOBase::Pointer io = MakeIo(format);
  std::vector<char> bytes;
  WithType(type, [&]<class T>(T) { ConvertTo<T>(image.values, bytes); });
  try {
    io->SetFileName(path.string());
    io->SetNumberOfDimensions(3);
    itk::ImageIORegion region(3);
    for (unsigned axis = 0; axis < 3; ++axis) {
      io->SetDimensions(axis, image.size[axis]);
      io->SetSpacing(axis, image.spacing[axis] / kMillimetre);
      io->SetOrigin(axis, image.origin[axis] / kMillimetre);
      const Vec3 direction = image.direction.col(axis);
      io->SetDirection(axis, std::vector<double>(direction.data(), direction.data() + 3));
      region.SetSize(axis, image.size[axis]);
    }
    io->SetIORegion(region);
    io->SetNumberOfComponents(1);
    io->SetPixelType(itk::CommonEnums::IOPixel::SCALAR);
    io->SetComponentType(ComponentOf(type));
    io->SetUseCompression(true);
    io->WriteImageInformation();
    io->Write(bytes.data());
  } catch (const std::exception&) {
    return false;
  }
  return true;
}

}  // namespace fascicle
