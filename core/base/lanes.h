#ifndef FASCICLE_CORE_BASE_LANES_H_
#define FASCICLE_CORE_BASE_LANES_H_

#include <cstdint>
#include <cstring>
#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include "core/base/numbers.h"

// Several numbers side by side in a vector register, one for each of several elements.
//
// Every operation, logarithm and exponential included, treats each lane alike, whatever the number of lanes. Formulas
// therefore give the same bits for any width, provided that the compiler fuses no multiplication with an addition
// (-ffp-contract=off).
//
// A file that is compiled for an instruction set must instantiate the templates it includes with the tag of that set
// only: to the linker, a function of the same name compiled for another set is the same function.
namespace fascicle {

// Tags of the instruction sets that kernels are compiled for.
struct BaselineSet {  // SSE2 on x86-64, the compiler's default elsewhere
  static constexpr int kBytes = 16;
};
struct Avx2Set {
  static constexpr int kBytes = 32;
};
struct Avx512Set {
  static constexpr int kBytes = 64;
};

// 1/i!, and the coefficients 2/(2i + 1) of artanh.
struct SeriesTerms {
  constexpr SeriesTerms() {
    double factorial = 1;
    for (int i = 0; i < 14; ++i) {
      if (i > 0) factorial *= i;
      exp[i] = 1 / factorial;
      log[i] = 2.0 / (2 * i + 1);
    }
  }
  double exp[14] = {}, log[14] = {};
};
inline constexpr SeriesTerms kSeries;

template <class S>
struct BitsOf;
template <>
struct BitsOf<double> {
  using Unsigned = std::uint64_t;
  using Signed = std::int64_t;
  static constexpr int kMantissa = 52;
  static constexpr Unsigned kOne = 0x3ff0000000000000u;       // 1
  static constexpr Unsigned kRootHalf = 0x3fe6a09e667f3bcdu;  // sqrt(1/2)
  static constexpr double kBias = 1023;
  // ln 2 in two parts. The first ends in zero bits, so that its integer multiples are exact.
  static constexpr double kLn2High = 0x1.62e42feep-1, kLn2Low = 0x1.a39ef35793c76p-33;
  static constexpr double kLeastNormal = 0x1p-1022;
  static constexpr double kExpOverflow = 709.782712893384, kExpUnderflow = -708;
  static constexpr int kLogTerms = 9, kExpTerms = 13;
  static constexpr int kRootBits = 20;  // of the initial guess of a cube root
};
template <>
struct BitsOf<float> {
  using Unsigned = std::uint32_t;
  using Signed = std::int32_t;
  static constexpr int kMantissa = 23;
  static constexpr Unsigned kOne = 0x3f800000u;
  static constexpr Unsigned kRootHalf = 0x3f3504f3u;
  static constexpr double kBias = 127;
  static constexpr double kLn2High = 0x1.62e4p-1, kLn2Low = 0x1.7f7d1cp-20;
  static constexpr double kLeastNormal = 0x1p-126;
  static constexpr double kExpOverflow = 88.72283, kExpUnderflow = -87;
  static constexpr int kLogTerms = 4, kExpTerms = 7;
  static constexpr int kRootBits = 10;
};

// A mask in a vector register: all bits of a true lane are set, as vector comparisons return it.
template <class Integer, class Set, int kWidth, int kBytes>
struct LaneMask {
  typedef Integer Integers __attribute__((vector_size(kBytes)));
  Integers bits;
  friend LaneMask operator&(LaneMask a, LaneMask b) { return {a.bits & b.bits}; }
  friend LaneMask operator|(LaneMask a, LaneMask b) { return {a.bits | b.bits}; }
  friend LaneMask operator!(LaneMask a) { return {~a.bits}; }
  bool operator[](int lane) const { return bits[lane] != 0; }
  bool Any() const {
    bool any = false;
    for (int k = 0; k < kWidth; ++k) any |= bits[k] != 0;
    return any;
  }
};
#if defined(__AVX512F__)
// A mask in a mask register, as AVX-512 comparisons return it.
template <class Integer, class Set, int kWidth>
struct LaneMask<Integer, Set, kWidth, 64> {
  static constexpr unsigned kAll = (1u << kWidth) - 1;
  unsigned bits;
  friend LaneMask operator&(LaneMask a, LaneMask b) { return {a.bits & b.bits}; }
  friend LaneMask operator|(LaneMask a, LaneMask b) { return {a.bits | b.bits}; }
  friend LaneMask operator!(LaneMask a) { return {~a.bits & kAll}; }
  bool operator[](int lane) const { return (bits >> lane & 1) != 0; }
  bool Any() const { return bits != 0; }
};
#endif

template <class S, class Set, int kWidth = Set::kBytes / static_cast<int>(sizeof(S))>
struct Lanes {
  using Scalar = S;
  using Tag = Set;
  using Bits = BitsOf<S>;
  static constexpr int kLanes = kWidth;
  static constexpr int kBytes = kWidth * static_cast<int>(sizeof(S));
  typedef S Vector __attribute__((vector_size(kWidth * sizeof(S))));
  typedef typename Bits::Signed Integers __attribute__((vector_size(kWidth * sizeof(S))));
  typedef typename Bits::Unsigned Naturals __attribute__((vector_size(kWidth * sizeof(S))));

  using Mask = LaneMask<typename Bits::Signed, Set, kWidth, kBytes>;

  Lanes() = default;
  // x - 0 is x for every x and costs no operation. 0 + x is not x when x = -0.
  Lanes(double x) : v(static_cast<S>(x) - Vector{}) {}  // NOLINT: numbers in formulas convert implicitly
  static Lanes Of(Vector v) {
    Lanes x;
    x.v = v;
    return x;
  }
  static Lanes Load(const S* p) {
    Lanes x;
    std::memcpy(&x.v, p, sizeof x.v);
    return x;
  }
  void Store(S* p) const { std::memcpy(p, &v, sizeof v); }
  S operator[](int lane) const { return v[lane]; }

  friend Lanes operator+(Lanes a, Lanes b) { return Of(a.v + b.v); }
  friend Lanes operator-(Lanes a, Lanes b) { return Of(a.v - b.v); }
  friend Lanes operator*(Lanes a, Lanes b) { return Of(a.v * b.v); }
  friend Lanes operator/(Lanes a, Lanes b) { return Of(a.v / b.v); }
  friend Lanes operator-(Lanes a) { return Of(-a.v); }
  Lanes& operator+=(Lanes b) { return *this = *this + b; }
  Lanes& operator-=(Lanes b) { return *this = *this - b; }
  Lanes& operator*=(Lanes b) { return *this = *this * b; }
  friend Mask operator<(Lanes a, Lanes b) { return Compared<kLess>(a, b); }
  friend Mask operator>(Lanes a, Lanes b) { return Compared<kLess>(b, a); }
  friend Mask operator<=(Lanes a, Lanes b) { return Compared<kLessOrEqual>(a, b); }
  friend Mask operator>=(Lanes a, Lanes b) { return Compared<kLessOrEqual>(b, a); }
  friend Mask operator==(Lanes a, Lanes b) { return Compared<kEqual>(a, b); }

  friend Lanes Select(Mask m, Lanes yes, Lanes no) {
#if defined(__AVX512F__)
    if constexpr (kBytes == 64 && sizeof(S) == 8) {
      return Of((Vector)_mm512_mask_blend_pd(static_cast<__mmask8>(m.bits), (__m512d)no.v, (__m512d)yes.v));
    } else if constexpr (kBytes == 64) {
      return Of((Vector)_mm512_mask_blend_ps(static_cast<__mmask16>(m.bits), (__m512)no.v, (__m512)yes.v));
    } else
#endif
      return Of(m.bits ? yes.v : no.v);
  }

  friend Lanes Sqrt(Lanes x) {
#if defined(__AVX512F__)
    if constexpr (kBytes == 64 && sizeof(S) == 8) return Of((Vector)_mm512_sqrt_pd((__m512d)x.v));
    if constexpr (kBytes == 64 && sizeof(S) == 4) return Of((Vector)_mm512_sqrt_ps((__m512)x.v));
#endif
#if defined(__AVX__)
    if constexpr (kBytes == 32 && sizeof(S) == 8) return Of((Vector)_mm256_sqrt_pd((__m256d)x.v));
    if constexpr (kBytes == 32 && sizeof(S) == 4) return Of((Vector)_mm256_sqrt_ps((__m256)x.v));
#endif
#if defined(__SSE2__)
    if constexpr (kBytes == 16 && sizeof(S) == 8) return Of((Vector)_mm_sqrt_pd((__m128d)x.v));
    if constexpr (kBytes == 16 && sizeof(S) == 4) return Of((Vector)_mm_sqrt_ps((__m128)x.v));
#endif
    Vector root{};
    for (int k = 0; k < kWidth; ++k) root[k] = static_cast<S>(__builtin_sqrt(x.v[k]));
    return Of(root);
  }

  // ln x to about an ulp; not finite where x is negative, zero, below the normal numbers or not finite.
  //
  // x = 2^k (1 + f); with s = f/(2 + f), ln(1 + f) = 2 artanh s = f - s (f - R), R = sum of 2 s^(2i)/(2i + 1) from
  // i = 1.
  friend Lanes Log(Lanes x) {
    const BinaryParts parts(x);
    const Lanes k = parts.k, f = parts.f;
    const Lanes s = f / (f + 2);
    const Lanes z = s * s;
    const Lanes R = z * Polynomial<1, Bits::kLogTerms>(kSeries.log, Powers(z));
    const Lanes log = k * Bits::kLn2High - ((s * (f - R) - k * Bits::kLn2Low) - f);
    const Lanes not_a_number = __builtin_nan("");
    const Lanes infinity = __builtin_inf();
    const Lanes of_positive = Select(x < infinity, log, infinity);
    return Select(x >= Bits::kLeastNormal, of_positive, Select(x >= 0, -infinity, not_a_number));
  }

  // exp x and exp x - 1 to about an ulp; exp x - 1 is accurate for small x, too.
  friend Lanes Exp(Lanes x) {
    const PowerOfE e(x);
    return e.Clipped(e.scale * e.rest + e.scale, x, 0);
  }
  friend Lanes Expm1(Lanes x) {
    const PowerOfE e(x);
    return e.Clipped(e.scale * e.rest + (e.scale - 0.5), x, -1);
  }

  // x^(-1/3) to about an ulp; NaN where x is not positive or is subnormal. Takes a fraction of the time of a logarithm
  // and an exponential.
  //
  // The initial guess is 2^t with t = -(ln x / ln 2)/3, where both the logarithm and the power are replaced by straight
  // lines.
  friend Lanes InverseCubeRoot(Lanes x) {
    const BinaryParts parts(x);
    // Adding a large number leaves t in the lowest bits, as a multiple of a power of two.
    constexpr int kShift = Bits::kMantissa - Bits::kRootBits;
    const Lanes magic = 1.5 * static_cast<double>(std::uint64_t{1} << kShift);
    const Lanes t = (parts.k + parts.f * 1.4) * (-1.0 / 3.0) + (magic - 0.04);
    const Lanes guess = Of((Vector)((((Naturals)t.v - (Naturals)magic.v) << kShift) + Bits::kOne));
    return Select(x >= Bits::kLeastNormal, RefinedInverseCubeRoot(x, guess), __builtin_nan(""));
  }

  template <class Function>
  friend Lanes Map(const Function& f, Lanes x) {
    Lanes result;
    for (int k = 0; k < kWidth; ++k) result.v[k] = static_cast<S>(f(x.v[k]));
    return result;
  }
  template <class Function>
  friend Lanes Map(const Function& f, Lanes x, Lanes y) {
    Lanes result;
    for (int k = 0; k < kWidth; ++k) result.v[k] = static_cast<S>(f(x.v[k], y.v[k]));
    return result;
  }

  Vector v;

 private:
  enum Comparison { kLess, kLessOrEqual, kEqual };  // false where either is NaN
  template <Comparison kComparison>
  static Mask Compared(Lanes a, Lanes b) {
#if defined(__AVX512F__)
    constexpr int kCode = kComparison == kLess ? _CMP_LT_OQ : kComparison == kLessOrEqual ? _CMP_LE_OQ : _CMP_EQ_OQ;
    if constexpr (kBytes == 64 && sizeof(S) == 8) {
      return {_mm512_cmp_pd_mask((__m512d)a.v, (__m512d)b.v, kCode)};
    } else if constexpr (kBytes == 64) {
      return {_mm512_cmp_ps_mask((__m512)a.v, (__m512)b.v, kCode)};
    } else
#endif
      return {kComparison == kLess          ? Integers(a.v < b.v)
              : kComparison == kLessOrEqual ? Integers(a.v <= b.v)
                                            : Integers(a.v == b.v)};
  }

  // x = 2^k (1 + f), 1 + f in [sqrt(1/2), sqrt(2)).
  struct BinaryParts {
    explicit BinaryParts(Lanes x) {
      const Naturals bits = (Naturals)x.v;
      const Naturals shifted = bits + (Bits::kOne - Bits::kRootHalf);
      const Naturals exponent = shifted >> Bits::kMantissa;
      const Naturals m = bits - (exponent << Bits::kMantissa) + Bits::kOne;
      // The exponent as a number: placed in the lowest bits of a number whose last bit has weight 1.
      const Lanes big = static_cast<double>(std::uint64_t{1} << Bits::kMantissa);
      k = Of((Vector)(exponent | (Naturals)big.v)) - big - Bits::kBias;
      f = Of((Vector)m) - 1;
    }
    Lanes k, f;
  };

  struct Powers {
    explicit Powers(Lanes x) : first(x), square(x * x), fourth(square * square), eighth(fourth * fourth) {}
    Lanes first, square, fourth, eighth;
  };
  // c[kFirst] + c[kFirst + 1] x + c[kFirst + 2] x^2 + ..., kCount terms, by Estrin's scheme: a few more operations than
  // Horner's, but most of them are independent of each other.
  template <int kFirst, int kCount>
  static Lanes Polynomial(const double* c, const Powers& x) {
    if constexpr (kCount == 1) {
      return c[kFirst];
    } else if constexpr (kCount == 2) {
      return c[kFirst] + c[kFirst + 1] * x.first;
    } else {
      constexpr int kHalf = kCount > 8 ? 8 : kCount > 4 ? 4 : 2;
      const Lanes& power = kHalf == 8 ? x.eighth : kHalf == 4 ? x.fourth : x.square;
      return Polynomial<kFirst, kHalf>(c, x) + power * Polynomial<kFirst + kHalf, kCount - kHalf>(c, x);
    }
  }

  // exp x = 2 scale (1 + rest), 2 scale = 2^k, rest = exp r - 1 with |r| <= ln 2 / 2. Half of 2^k is representable even
  // where 2^k itself overflows.
  struct PowerOfE {
    explicit PowerOfE(Lanes x) {
      // Adding 1.5 2^mantissa rounds to an integer and leaves it in the lowest bits.
      const Lanes magic = 1.5 * static_cast<double>(std::uint64_t{1} << Bits::kMantissa);
      const Lanes shifted = x * 0x1.71547652b82fep0 + magic;
      const Lanes k = shifted - magic;
      const Lanes r = (x - k * Bits::kLn2High) - k * Bits::kLn2Low;
      const Naturals half_less = (Naturals)shifted.v - (Naturals)magic.v - 1;
      scale = Of((Vector)((half_less << Bits::kMantissa) + Bits::kOne));
      const Powers of_r(r);
      rest = r + of_r.square * Polynomial<2, Bits::kExpTerms - 1>(kSeries.exp, of_r);
    }
    Lanes Clipped(Lanes half, Lanes x, double least) const {
      const Lanes infinity = __builtin_inf();
      const Lanes inside = Select(x >= Bits::kExpUnderflow, half + half, x);
      return Select(x < Bits::kExpUnderflow, least, Select(x > Bits::kExpOverflow, infinity, inside));
    }
    Lanes scale, rest;
  };
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_BASE_LANES_H_
