#include "core/materials/material.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <utility>

namespace fascicle {

template <class Law>
double LawFunctions<Law>::Energy(const Mat3& F, const FibreState& fibre) const {
  return static_cast<const Law&>(*this).EnergyAt(ToNumbers(F), ToNumbers(fibre));
}
template <class Law>
Mat3 LawFunctions<Law>::Stress(const Mat3& F, const FibreState& fibre) const {
  return ToEigen(static_cast<const Law&>(*this).StressAt(ToNumbers(F), ToNumbers(fibre)));
}
template <class Law>
Mat9 LawFunctions<Law>::Tangent(const Mat3& F, const FibreState& fibre) const {
  TangentMatrix<double> terms;
  static_cast<const Law&>(*this).AddTangentAt(ToNumbers(F), ToNumbers(fibre), terms);
  Mat9 tangent;
  int place = 0;
  for (int i = 0; i < 9; ++i) {
    for (int j = i; j < 9; ++j) tangent(i, j) = tangent(j, i) = terms[place++];
  }
  return tangent;
}
template class LawFunctions<LinearElastic>;
template class LawFunctions<StVenantKirchhoff>;
template class LawFunctions<CorotatedLinear>;
template class LawFunctions<NeoHookean>;
template class LawFunctions<MooneyRivlin>;
template class LawFunctions<Muscle>;
template class LawFunctions<Tendon>;
template class LawFunctions<TransIsoMooneyRivlin>;
template class LawFunctions<Yeoh>;
template class LawFunctions<Ogden>;
template class LawFunctions<FungFibre>;
template class LawFunctions<HolzapfelGasserOgden>;
template class LawFunctions<TabulatedMuscle>;
template class LawFunctions<BlemkerMuscle>;
template class LawFunctions<BlemkerTendon>;

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
