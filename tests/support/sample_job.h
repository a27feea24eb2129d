#ifndef FASCICLE_TESTS_SUPPORT_SAMPLE_JOB_H_
#define FASCICLE_TESTS_SUPPORT_SAMPLE_JOB_H_

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "fascicle/v1/frame.pb.h"

namespace fascicle::testing {

template <class T>
std::string Bytes(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

// A handmade spindle along z of 100 mm, whose frames shorten and bulge it by a known map.
class SampleJob {
 public:
  static constexpr int kAcross = 6, kAlong = 16;
  static constexpr double kLength = 0.1;

  SampleJob() {
    for (int k = 0; k <= kAlong; ++k) {
      for (int j = 0; j <= kAcross; ++j) {
        for (int i = 0; i <= kAcross; ++i) AddNode(2.0 * i / kAcross - 1, 2.0 * j / kAcross - 1, 1.0 * k / kAlong);
      }
    }
    for (int k = 0; k < kAlong; ++k) {
      for (int j = 0; j < kAcross; ++j) {
        for (int i = 0; i < kAcross; ++i) AddHexahedron(i, j, k);
      }
    }
  }

  std::size_t nodes() const { return positions_.size() / 3; }
  std::size_t tetrahedra() const { return tetrahedra_.size() / 4; }

  v1::Geometry geometry() const {
    v1::Geometry geometry;
    v1::BodyGeometry& body = *geometry.add_bodies();
    body.set_name("belly");
    body.set_positions(Bytes(positions_));
    body.set_tetrahedra(Bytes(tetrahedra_));
    std::vector<double> fibres;
    for (std::size_t e = 0; e < tetrahedra(); ++e) fibres.insert(fibres.end(), {0, 0, 1});
    body.set_fibres(Bytes(fibres));
    v1::RegionGeometry& region = *body.add_regions();
    region.set_name("origin");
    std::vector<std::uint32_t> origin((kAcross + 1) * (kAcross + 1));
    for (std::size_t i = 0; i < origin.size(); ++i) origin[i] = static_cast<std::uint32_t>(i);
    region.set_nodes(Bytes(origin));
    for (const auto& [name, unit] : {std::pair{"energy/elastic", "J"}, {"belly/reaction/origin/z", "N"}}) {
      v1::SeriesInfo& info = *geometry.add_series();
      info.set_name(name);
      info.set_unit(unit);
    }
    return geometry;
  }

  // x and y grow by 1 + 0.03 index sin^2(pi z / L); the stress is 1000 z / L, constant per tetrahedron.
  v1::Frame frame(int index) const {
    v1::Frame frame;
    frame.set_index(index);
    frame.set_time(0.05 * index);
    frame.set_step(10 * index);
    std::vector<double> moved = positions_;
    std::vector<double> velocity;
    for (std::size_t i = 0; i < moved.size(); i += 3) {
      const double s = std::sin(std::numbers::pi * moved[i + 2] / kLength);
      moved[i] *= 1 + 0.03 * index * s * s;
      moved[i + 1] *= 1 + 0.03 * index * s * s;
      velocity.insert(velocity.end(), {0, 0, 0.5});
    }
    std::vector<double> stress;
    for (std::size_t e = 0; e < tetrahedra(); ++e) {
      double z = 0;
      for (int n = 0; n < 4; ++n) z += positions_[3 * tetrahedra_[4 * e + static_cast<std::size_t>(n)] + 2] / 4;
      stress.push_back(1000 * z / kLength);
    }
    v1::BodyFrame& body = *frame.add_bodies();
    body.set_positions(Bytes(moved));
    AddField("velocity", v1::FieldValues::LOCATION_NODE, 3, "m/s", velocity, body);
    AddField("von_mises_stress", v1::FieldValues::LOCATION_TETRAHEDRON, 1, "Pa", stress, body);
    frame.add_series(1e-3 * index * index);
    frame.add_series(-2.5 * index);
    frame.set_digest(std::string(32, static_cast<char>(index)));
    return frame;
  }

  const std::vector<double>& positions() const { return positions_; }

 private:
  void AddNode(double u, double v, double w) {
    const double s = std::sin(std::numbers::pi * w);
    const double radius = 0.006 + 0.010 * s * s;
    // Maps a square to a disc.
    positions_.insert(positions_.end(),
                      {radius * u * std::sqrt(1 - v * v / 2), radius * v * std::sqrt(1 - u * u / 2), kLength * w});
  }

  void AddHexahedron(int i, int j, int k) {
    const auto node = [&](int a, int b, int c) {
      return static_cast<std::uint32_t>((i + a) + (kAcross + 1) * ((j + b) + (kAcross + 1) * (k + c)));
    };
    const std::array<std::uint32_t, 8> n = {node(0, 0, 0), node(1, 0, 0), node(1, 1, 0), node(0, 1, 0),
                                            node(0, 0, 1), node(1, 0, 1), node(1, 1, 1), node(0, 1, 1)};
    for (const auto& t : {std::array{0u, 1u, 2u, 6u},
                          {0u, 2u, 3u, 6u},
                          {0u, 3u, 7u, 6u},
                          {0u, 7u, 4u, 6u},
                          {0u, 4u, 5u, 6u},
                          {0u, 5u, 1u, 6u}}) {
      for (const unsigned local : t) tetrahedra_.push_back(n[local]);
    }
  }

  static void AddField(const char* name, v1::FieldValues::Location location, int components, const char* unit,
                       const std::vector<double>& values, v1::BodyFrame& body) {
    v1::FieldValues& field = *body.add_fields();
    field.set_name(name);
    field.set_location(location);
    field.set_components(components);
    field.set_unit(unit);
    field.set_values(Bytes(values));
  }

  std::vector<double> positions_;
  std::vector<std::uint32_t> tetrahedra_;
};

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_SUPPORT_SAMPLE_JOB_H_
