#ifndef FASCICLE_CORE_MATERIALS_ISOTROPIC_MODULI_H_
#define FASCICLE_CORE_MATERIALS_ISOTROPIC_MODULI_H_

#include <array>
#include <span>

#include "core/materials/constitutive_model.h"

namespace fascicle {

// The two small-strain moduli of laws that are parametrized by Young's modulus and Poisson's ratio.
struct IsotropicModuli {
  static constexpr std::array<ParameterInfo, 2> kParameters = {{
      {"young_modulus", "Pa", 0, true, 1e12, false, kRequired, "Young's modulus at small strain"},
      {"poisson_ratio", "1", -1, true, 0.5, true, 0.3, "Poisson's ratio at small strain"},
  }};

  // values: Young's modulus E > 0 [Pa], Poisson's ratio nu in (-1, 0.5) [1].
  explicit IsotropicModuli(std::span<const double> values)
      : mu(values[0] / (2 * (1 + values[1]))),
        lambda(values[0] * values[1] / ((1 + values[1]) * (1 - 2 * values[1]))) {}

  double Bulk() const { return lambda + 2 * mu / 3; }

  double mu;      // shear modulus [Pa]
  double lambda;  // Lame's first modulus [Pa]
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_ISOTROPIC_MODULI_H_
