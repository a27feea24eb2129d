#ifndef FASCICLE_CLIENT_IMPORT_CURVES_H_
#define FASCICLE_CLIENT_IMPORT_CURVES_H_

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "client/import/model.h"
#include "client/import/xml_source.h"

namespace fascicle::client {

// Converts load controllers to curves of a scene.
class CurveMaker {
 public:
  CurveMaker(const Model& model, XmlSource& source) : model_(model), source_(source) {}

  // `factor` times the controller, within [low, high]. Nothing, with a problem at `node`, if there is no such curve or
  // if it leaves the range. Without a controller the value is reached at the end of the first time step, as in FEBio.
  std::optional<v1::Curve> Make(double factor, const std::optional<std::int64_t>& controller, double low, double high,
                                pugi::xml_node node);
  // The same for a motion: it starts at rest, and a jump in FEBio takes the first time step.
  std::optional<v1::Curve> MakeMotion(double factor, const std::optional<std::int64_t>& controller, double low,
                                      double high, pugi::xml_node node);
  // The same for an activation, in [0, 1]; lower values, to which smooth curves may fall, become 0.
  std::optional<v1::Curve> MakeActivation(double factor, const std::optional<std::int64_t>& controller,
                                          pugi::xml_node node);
  // The largest value of such an activation; 0 if it has none.
  double Largest(const Driven& driven);

 private:
  struct Points {
    std::vector<double> times, values;
    void Add(double time, double value) {
      times.push_back(time);
      values.push_back(value);
    }
    // The same, unless the time is not later than the last one.
    void AddLater(double time, double value) {
      if (time > times.back()) Add(time, value);
    }
  };
  // The points of a controller from 0 to the end of the analysis, or to where it is constant; computed once.
  std::optional<Points> Resolve(std::int64_t controller, pugi::xml_node node);
  std::optional<Points> Compute(std::int64_t controller, pugi::xml_node node);
  // Nothing if there are too many.
  std::optional<Points> OfFormula(std::int64_t controller, const LoadCurve& curve);
  std::optional<Points> OfPoints(std::int64_t controller, const LoadCurve& curve);
  // Times within an interval of a curve at which it is sampled, among them the ends of time steps.
  std::vector<double> SampleTimes(const LoadCurve& curve, std::size_t interval) const;
  // Extends points to the end of the analysis, or to its begin. False if there are too many.
  bool ExtendAfter(const LoadCurve& curve, Points& points) const;
  bool ExtendBefore(const LoadCurve& curve, Points& points) const;
  static bool MayExtrapolate(const LoadCurve& curve);
  bool InRange(const v1::Curve& curve, double low, double high, pugi::xml_node node);
  std::optional<v1::Curve> ToCurve(double factor, const Points& points, double low, double high, pugi::xml_node node);
  void TellOnce(std::int64_t controller, const LoadCurve& curve, const char* message);
  double End() const { return model_.control.steps * model_.control.step_size; }

  const Model& model_;
  XmlSource& source_;
  std::set<std::int64_t> told_;
  std::map<std::int64_t, std::optional<Points>> resolved_;
};

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_IMPORT_CURVES_H_
