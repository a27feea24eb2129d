#ifndef FASCICLE_CORE_SCENE_FIELDS_H_
#define FASCICLE_CORE_SCENE_FIELDS_H_

#include <array>
#include <cstddef>
#include <type_traits>

#include "core/base/types.h"

namespace fascicle {

// The members of the scene's structs, listed once. Operations on every field of a scene (fingerprint.h, curves.h) use
// VisitFields instead of lists of their own.

// The names of the members of `Struct` in their order, as in scene.proto; "" where its messages do not have this level.
// Each struct of a scene is followed by its names. Visiting a struct whose numbers of members and names differ does not
// compile.
template <class Struct>
inline constexpr std::array<const char*, 0> kFieldNames = {};

template <class... Names>
constexpr std::array<const char*, sizeof...(Names)> FieldNames(Names... names) {
  return {names...};
}

template <class Struct>
concept HasFields = !kFieldNames<std::remove_const_t<Struct>>.empty();

// Numbers, and matrices and arrays of numbers: stored without gaps and without members of their own.
template <class Value>
inline constexpr bool kIsFlat = std::is_arithmetic_v<Value> || std::is_enum_v<Value>;
template <class Scalar, int kRows, int kColumns>
inline constexpr bool kIsFlat<Eigen::Matrix<Scalar, kRows, kColumns>> =
    kRows != Eigen::Dynamic&& kColumns != Eigen::Dynamic;
template <class Value, std::size_t kCount>
inline constexpr bool kIsFlat<std::array<Value, kCount>> = kIsFlat<Value>;

namespace internal {

// Calls call(members...) with references to all members of `s`.
template <std::size_t kCount, class Struct, class Call>
void WithMembers(Struct& s, const Call& call) {
  if constexpr (kCount == 1) {
    auto& [a] = s;
    call(a);
  } else if constexpr (kCount == 2) {
    auto& [a, b] = s;
    call(a, b);
  } else if constexpr (kCount == 3) {
    auto& [a, b, c] = s;
    call(a, b, c);
  } else if constexpr (kCount == 4) {
    auto& [a, b, c, d] = s;
    call(a, b, c, d);
  } else if constexpr (kCount == 5) {
    auto& [a, b, c, d, e] = s;
    call(a, b, c, d, e);
  } else if constexpr (kCount == 6) {
    auto& [a, b, c, d, e, f] = s;
    call(a, b, c, d, e, f);
  } else if constexpr (kCount == 7) {
    auto& [a, b, c, d, e, f, g] = s;
    call(a, b, c, d, e, f, g);
  } else if constexpr (kCount == 8) {
    auto& [a, b, c, d, e, f, g, h] = s;
    call(a, b, c, d, e, f, g, h);
  } else if constexpr (kCount == 9) {
    auto& [a, b, c, d, e, f, g, h, i] = s;
    call(a, b, c, d, e, f, g, h, i);
  } else if constexpr (kCount == 10) {
    auto& [a, b, c, d, e, f, g, h, i, j] = s;
    call(a, b, c, d, e, f, g, h, i, j);
  } else if constexpr (kCount == 11) {
    auto& [a, b, c, d, e, f, g, h, i, j, k] = s;
    call(a, b, c, d, e, f, g, h, i, j, k);
  } else if constexpr (kCount == 12) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l] = s;
    call(a, b, c, d, e, f, g, h, i, j, k, l);
  } else if constexpr (kCount == 13) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m] = s;
    call(a, b, c, d, e, f, g, h, i, j, k, l, m);
  } else if constexpr (kCount == 14) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n] = s;
    call(a, b, c, d, e, f, g, h, i, j, k, l, m, n);
  } else {
    static_assert(kCount == 15, "longer structs need another line here");
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o] = s;
    call(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o);
  }
}

}  // namespace internal

// Calls visit(name, member) for each member of `s`, in order.
template <HasFields Struct, class Visit>
void VisitFields(Struct& s, const Visit& visit) {
  constexpr const auto& names = kFieldNames<std::remove_const_t<Struct>>;
  internal::WithMembers<names.size()>(s, [&](auto&... members) {
    std::size_t k = 0;
    (visit(names[k++], members), ...);
  });
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_SCENE_FIELDS_H_
