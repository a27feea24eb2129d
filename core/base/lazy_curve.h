#ifndef FASCICLE_CORE_BASE_LAZY_CURVE_H_
#define FASCICLE_CORE_BASE_LAZY_CURVE_H_

#include <utility>

#include "core/base/line_fitter.h"

namespace fascicle {

// A polyline that is computed only up to the largest time at which it was evaluated, such as the solution of a
// differential equation that is integrated with a run. Its bits do not depend on the order of evaluations, nor on being
// saved and loaded. Not thread-safe.
//
// Points generates the points that LineFitter simplifies:
//   bool AddNext(LineFitter&)  adds one or more points, the first at time 0; false if there are no more
//   void Save(ArchiveWriter&) const, void Load(ArchiveReader&)  its position in the sequence
template <class Points>
class LazyCurve {
 public:
  // tolerance: largest distance of the points from the polyline, in the curve's unit.
  LazyCurve(Points points, double tolerance) : points_(std::move(points)), fitter_(tolerance) {
    points_.AddNext(fitter_);
  }

  // time: not before that of the last DiscardBefore.
  double At(double time) {
    ExtendTo(time);
    return fitter_.curve().At(time);
  }
  // Whether it is constant from a time on.
  bool RestsAt(double time) {
    ExtendTo(time);
    return is_complete_ && time >= fitter_.curve().end();
  }
  // Frees the memory of points before a time.
  void DiscardBefore(double time) { fitter_.DiscardBefore(time); }

  void Save(ArchiveWriter& archive) const {
    archive.PutInt("is_complete", is_complete_ ? 1 : 0);
    points_.Save(archive);
    fitter_.Save(archive);
  }
  void Load(ArchiveReader& archive) {
    is_complete_ = archive.GetInt("is_complete") != 0;
    points_.Load(archive);
    fitter_.Load(archive);
    if (fitter_.curve().times.empty()) archive.Fail();
  }

 private:
  void ExtendTo(double time) {
    while (!is_complete_ && fitter_.curve().end() <= time) {
      is_complete_ = !points_.AddNext(fitter_);
      if (is_complete_) fitter_.Finish();
    }
  }

  Points points_;
  LineFitter fitter_;
  bool is_complete_ = false;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_BASE_LAZY_CURVE_H_
