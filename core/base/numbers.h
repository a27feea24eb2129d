#ifndef FASCICLE_CORE_BASE_NUMBERS_H_
#define FASCICLE_CORE_BASE_NUMBERS_H_

#include <cmath>

// What formulas that are written once for one number and for many side by side (Lanes) do with their numbers. Here for
// double; in lanes.h for Lanes. A branch is a Select, and both its sides are evaluated.
namespace fascicle {

inline double Select(bool condition, double yes, double no) { return condition ? yes : no; }
inline double Sqrt(double x) { return std::sqrt(x); }
inline double Log(double x) { return std::log(x); }
inline double Exp(double x) { return std::exp(x); }
inline double Expm1(double x) { return std::expm1(x); }

// f of each number by itself, for what has no formula without branches.
template <class Function>
double Map(const Function& f, double x) {
  return f(x);
}
template <class Function>
double Map(const Function& f, double x, double y) {
  return f(x, y);
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_BASE_NUMBERS_H_
