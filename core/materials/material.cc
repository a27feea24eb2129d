#include "core/materials/material.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <utility>

namespace fascicle {
namespace {

template <class Law>
Material Make(std::span<const double> values) {
  return Law(values);
}

template <class Law>
constexpr LawInfo InfoOf() {
  return {Law::kName, Law::kTitle, Law::kSource, Law::kNeedsFibres, Law::kParameters, &Make<Law>};
}

template <std::size_t... kIndex>
constexpr auto InfosOf(std::index_sequence<kIndex...>) {
  return std::array{InfoOf<std::variant_alternative_t<kIndex, Material>>()...};
}

constexpr auto kLaws = InfosOf(std::make_index_sequence<std::variant_size_v<Material>>());

}  // namespace

bool InRange(const ParameterInfo& p, double value) {
  return std::isfinite(value) && (p.min_open ? value > p.min : value >= p.min) &&
         (p.max_open ? value < p.max : value <= p.max);
}

std::string RangeText(const ParameterInfo& p) {
  char text[80];
  std::snprintf(text, sizeof text, "%c%g, %g%c", p.min_open ? '(' : '[', p.min, p.max, p.max_open ? ')' : ']');
  return text;
}

std::span<const LawInfo> Laws() { return kLaws; }

const LawInfo* FindLaw(std::string_view name) {
  for (const LawInfo& law : kLaws) {
    if (name == law.name) return &law;
  }
  return nullptr;
}

}  // namespace fascicle
