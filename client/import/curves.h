#ifndef FASCICLE_CLIENT_IMPORT_CURVES_H_
#define FASCICLE_CLIENT_IMPORT_CURVES_H_

#include <cstdint>
#include <optional>
#include <set>

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

 private:
  struct Points {
    std::vector<double> times, values;
    void Add(double time, double value) {
      times.push_back(time);
      values.push_back(value);
    }
  };
  std::optional<Points> Resolve(std::int64_t controller, pugi::xml_node node);
  std::optional<v1::Curve> ToCurve(double factor, const Points& points, double low, double high, pugi::xml_node node);
  void TellOnce(std::int64_t controller, const LoadCurve& curve, const char* message);
  double End() const { return model_.control.steps * model_.control.step_size; }

  const Model& model_;
  XmlSource& source_;
  std::set<std::int64_t> told_;
};

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_IMPORT_CURVES_H_
