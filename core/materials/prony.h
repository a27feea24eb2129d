#ifndef FASCICLE_CORE_MATERIALS_PRONY_H_
#define FASCICLE_CORE_MATERIALS_PRONY_H_

#include <cmath>
#include <cstddef>
#include <vector>

namespace fascicle {

// Viscoelasticity of any law: Maxwell branches beside it, whose stresses H_i decay.
//
//   S = S_e + sum H_i,  dH_i/dt + H_i/tau_i = g_i dS_p/dt
//
// S is the second Piola-Kirchhoff stress, S_e that of the law, and S_p its passive part without the volume term K/2 (ln
// J)^2: neither volume changes nor activation relax. The law is what remains after a long time; suddenly its stress S_p
// is 1 + sum g_i times as large. [Simo 1987, On a fully three-dimensional finite-strain viscoelastic damage model,
// CMAME 60; Holzapfel 2000, Nonlinear solid mechanics, 6.10]
struct PronyTerm {
  double strength = 0;  // g > 0, relative to the law [1]
  double time = 0;      // relaxation time tau > 0 [s]
};

struct PronySeries {
  static constexpr std::size_t kMostTerms = 6;
  std::vector<PronyTerm> terms;  // none: an elastic material
};

// A branch over a step of length h in which S_p changes linearly, which is exact then:
//   H' = decay H + gain (S_p' - S_p),  decay = exp(-h/tau),  gain = g (1 - decay) tau/h
// [Taylor, Pister & Goudreau 1970, Thermomechanical analysis of viscoelastic solids, Int. J. Numer. Meth. Eng. 2]
struct BranchStep {
  BranchStep(const PronyTerm& term, double h) : decay(std::exp(-h / term.time)), gain(term.strength) {
    const double x = h / term.time;
    if (x > 0) gain *= -std::expm1(-x) / x;
  }
  double decay, gain;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_PRONY_H_
