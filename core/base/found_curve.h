#ifndef FASCICLE_CORE_BASE_FOUND_CURVE_H_
#define FASCICLE_CORE_BASE_FOUND_CURVE_H_

#include <utility>

#include "core/base/line_fitter.h"

namespace fascicle {

// A curve of straight lines that is found as far as it is asked for: the solution of an equation that is integrated
// with a run. The same bits however it is asked, and when it goes on from where it was saved. Not thread-safe.
//   Points  bool AddNext(LineFitter&)  adds the next points, at least one, the first at time 0; false: there are none
//           void Save(ArchiveWriter&) const, void Load(ArchiveReader&)  how far it is
template <class Points>
class FoundCurve {
 public:
  // tolerance: of the lines, in the curve's unit.
  FoundCurve(Points points, double tolerance) : points_(std::move(points)), fitter_(tolerance) {
    points_.AddNext(fitter_);
  }

  // Not before the time of the last Forget.
  double At(double time) {
    FindTo(time);
    return fitter_.curve().At(time);
  }
  // Whether it has come to rest by a time.
  bool RestsAt(double time) {
    FindTo(time);
    return is_whole_ && time >= fitter_.curve().end();
  }
  // Gives up what lies before a time.
  void Forget(double time) { fitter_.Forget(time); }

  void Save(ArchiveWriter& archive) const {
    archive.PutInt("is_whole", is_whole_ ? 1 : 0);
    points_.Save(archive);
    fitter_.Save(archive);
  }
  void Load(ArchiveReader& archive) {
    is_whole_ = archive.GetInt("is_whole") != 0;
    points_.Load(archive);
    fitter_.Load(archive);
    if (fitter_.curve().times.empty()) archive.Fail();
  }

 private:
  void FindTo(double time) {
    while (!is_whole_ && fitter_.curve().end() <= time) {
      is_whole_ = !points_.AddNext(fitter_);
      if (is_whole_) fitter_.Finish();
    }
  }

  Points points_;
  LineFitter fitter_;
  bool is_whole_ = false;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_BASE_FOUND_CURVE_H_
