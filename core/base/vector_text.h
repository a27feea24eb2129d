#ifndef FASCICLE_CORE_BASE_VECTOR_TEXT_H_
#define FASCICLE_CORE_BASE_VECTOR_TEXT_H_

#include <cstdio>
#include <string>

#include "core/base/types.h"

namespace fascicle {

// A point or direction in a message: "[0.1, 0.2, -3]".
inline std::string VectorText(const Vec3& v) {
  char text[96];
  std::snprintf(text, sizeof text, "[%.4g, %.4g, %.4g]", v[0], v[1], v[2]);
  return text;
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_BASE_VECTOR_TEXT_H_
