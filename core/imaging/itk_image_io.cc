#include "core/imaging/itk_image_io.h"

#include <gdcmTrace.h>
#include <itkGDCMImageIO.h>
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

namespace fascicle {
namespace {

using itk::ImageIOBase;
using Component = itk::CommonEnums::IOComponent;

constexpr double kMillimetre = 1e-3;  // [m]

// Silences libraries that print errors which are reported here anyway.
void Silence() {
  [[maybe_unused]] static const bool once = [] {
    itk::Object::GlobalWarningDisplayOff();
    gdcm::Trace::WarningOff();
    gdcm::Trace::ErrorOff();
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
      return itk::GDCMImageIO::New().GetPointer();
    case VolumeFormat::kRaw:
      break;
  }
  FASCICLE_CHECK(false, "raw files are read without ITK");
}

template <class T>
void Convert(const char* bytes, std::size_t count, float* values) {
  for (std::size_t i = 0; i < count; ++i) {
    T value;
    std::memcpy(&value, bytes + i * sizeof(T), sizeof(T));
    values[i] = static_cast<float>(value);
  }
}

// False for types that do not occur in images.
bool ConvertComponents(Component type, const std::vector<char>& bytes, std::vector<float>& values) {
  const auto convert = [&]<class T>(T) { Convert<T>(bytes.data(), values.size(), values.data()); };
  switch (type) {
    case Component::UCHAR:
      convert(static_cast<unsigned char>(0));
      return true;
    case Component::CHAR:
      convert(static_cast<signed char>(0));
      return true;
    case Component::USHORT:
      convert(static_cast<unsigned short>(0));
      return true;
    case Component::SHORT:
      convert(static_cast<short>(0));
      return true;
    case Component::UINT:
      convert(0U);
      return true;
    case Component::INT:
      convert(0);
      return true;
    case Component::ULONG:
      convert(0UL);
      return true;
    case Component::LONG:
      convert(0L);
      return true;
    case Component::ULONGLONG:
      convert(0ULL);
      return true;
    case Component::LONGLONG:
      convert(0LL);
      return true;
    case Component::FLOAT:
      convert(0.0F);
      return true;
    case Component::DOUBLE:
      convert(0.0);
      return true;
    default:
      return false;
  }
}

void AddCantBeRead(VolumeFormat format, Problems& problems) {
  problems.Add("", "it can't be read as a " + NameOf(format) + " image",
               "is it complete, and is it what its extension says?");
}

// Accepts images of numbers in three dimensions; further dimensions must have length 1.
bool TakeHeader(const ImageIOBase& io, const ItkFile& file, std::int64_t memory_limit, VolumeImage& image,
                Problems& problems) {
  if (io.GetNumberOfComponents() != 1) {
    problems.Add("", "the image has " + std::to_string(io.GetNumberOfComponents()) + " components a voxel",
                 "only one can be read: save one channel by itself");
    return false;
  }
  const std::uint64_t width = file.bytes_per_voxel > 0 ? file.bytes_per_voxel : io.GetComponentSize();
  VolumeClaim claim{{1, 1, 1}, width, file.bytes, file.compressed};
  const unsigned dimensions = io.GetNumberOfDimensions();
  for (unsigned axis = 0; axis < dimensions; ++axis) {
    const std::uint64_t length = io.GetDimensions(axis);
    if (axis < 3) {
      claim.size[axis] = length;
    } else if (length != 1) {
      problems.Add("", "the image has " + std::to_string(length) + " volumes, one for each time or channel",
                   "save the one that is wanted by itself");
      return false;
    }
  }
  if (!CheckClaim(claim, memory_limit, problems)) return false;
  for (unsigned axis = 0; axis < 3; ++axis) {
    image.size[axis] = static_cast<std::int32_t>(claim.size[axis]);
    if (axis >= dimensions) {
      image.spacing[axis] = image.spacing[0];
      continue;
    }
    image.spacing[axis] = io.GetSpacing(axis) * kMillimetre;
    image.origin[axis] = io.GetOrigin(axis) * kMillimetre;
    const std::vector<double> direction = io.GetDirection(axis);
    for (std::size_t row = 0; row < std::min<std::size_t>(3, direction.size()); ++row) {
      image.direction(static_cast<Eigen::Index>(row), axis) = direction[row];
    }
  }
  return CheckPlace(image, problems);
}

std::optional<ItkVolume> Read(const ItkFile& file, std::int64_t memory_limit, Problems& problems) {
  const ImageIOBase::Pointer io = MakeIo(file.format);
  const std::string path = file.path.string();
  if (!io->CanReadFile(path.c_str())) {
    AddCantBeRead(file.format, problems);
    return std::nullopt;
  }
  io->SetFileName(path);
  io->ReadImageInformation();
  ItkVolume volume;
  if (!TakeHeader(*io, file, memory_limit, volume.image, problems)) return std::nullopt;
  if (auto* dicom = dynamic_cast<itk::GDCMImageIO*>(io.GetPointer())) {
    // The series instance UID, without which ITK returns an empty text.
    dicom->GetValueFromTag("0020|000e", volume.series);
  }
  itk::ImageIORegion region(io->GetNumberOfDimensions());
  for (unsigned axis = 0; axis < io->GetNumberOfDimensions(); ++axis) region.SetSize(axis, io->GetDimensions(axis));
  io->SetIORegion(region);
  // ITK may temporarily need more bytes than the numbers take.
  std::vector<char> bytes(
      std::max<std::size_t>(io->GetImageSizeInBytes(), volume.image.voxels() * io->GetComponentSize()));
  io->Read(bytes.data());
  volume.image.values.resize(volume.image.voxels());
  if (!ConvertComponents(io->GetComponentType(), bytes, volume.image.values)) {
    problems.Add("", "the image's number type is unknown", "save them as 16-bit integers or floats");
    return std::nullopt;
  }
  if (!CheckValues(volume.image, problems)) return std::nullopt;
  return volume;
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

// Calls body(a number of that type).
template <class Body>
void WithType(VoxelType type, const Body& body) {
  switch (type) {
    case VoxelType::kUint8:
      return body(std::uint8_t{});
    case VoxelType::kInt8:
      return body(std::int8_t{});
    case VoxelType::kUint16:
      return body(std::uint16_t{});
    case VoxelType::kInt16:
      return body(std::int16_t{});
    case VoxelType::kUint32:
      return body(std::uint32_t{});
    case VoxelType::kInt32:
      return body(std::int32_t{});
    case VoxelType::kFloat32:
      return body(float{});
    case VoxelType::kFloat64:
      return body(double{});
  }
}

Component ComponentOf(VoxelType type) {
  constexpr Component kComponents[] = {Component::UCHAR, Component::CHAR, Component::USHORT, Component::SHORT,
                                       Component::UINT,  Component::INT,  Component::FLOAT,  Component::DOUBLE};
  return kComponents[static_cast<int>(type)];
}

}  // namespace

std::optional<ItkVolume> ReadByItk(const ItkFile& file, std::int64_t memory_limit, Problems& problems) {
  const std::size_t before = problems.count();
  try {
    return Read(file, memory_limit, problems);
  } catch (const std::exception&) {
    // ITK's messages contain class names and addresses, which do not help a user.
    if (problems.count() == before) AddCantBeRead(file.format, problems);
    return std::nullopt;
  }
}

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

void ConvertVoxels(VoxelType type, const char* bytes, std::size_t count, float* values) {
  WithType(type, [&]<class T>(T) { Convert<T>(bytes, count, values); });
}

std::size_t BytesOf(VoxelType type) {
  std::size_t bytes = 0;
  WithType(type, [&]<class T>(T) { bytes = sizeof(T); });
  return bytes;
}

}  // namespace fascicle
