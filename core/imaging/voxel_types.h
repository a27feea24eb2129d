#ifndef FASCICLE_CORE_IMAGING_VOXEL_TYPES_H_
#define FASCICLE_CORE_IMAGING_VOXEL_TYPES_H_

#include <cstdint>

#include "core/imaging/volume_reader.h"

// Internal to this room.
namespace fascicle {

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
    case VoxelType::kInt64:
      return body(std::int64_t{});
    case VoxelType::kUint64:
      return body(std::uint64_t{});
  }
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_VOXEL_TYPES_H_
