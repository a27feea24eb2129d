#ifndef FASCICLE_CLIENT_EXPORT_SAMPLE_H_
#define FASCICLE_CLIENT_EXPORT_SAMPLE_H_

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/lib/decode.h"
#include "fascicle/v1/frame.pb.h"

// Values of fields at points and over regions of bodies. All functions are pure.
namespace fascicle::client {

// A field of a body in one frame.
struct BodyField {
  std::string name;
  std::string unit;  // empty if unknown
  std::vector<std::string> components;
  bool at_nodes = true;
  std::vector<double> values;  // component fastest
};

// A body in one frame: `displacement` [m], then the fields of the frame.
struct BodySnapshot {
  BodyShape shape;
  std::vector<Vec3> positions;  // [m]
  std::vector<BodyField> fields;
};

// All bodies at one time.
struct Snapshot {
  std::int64_t frame = 0;
  double time = 0;  // [s]
  std::vector<BodySnapshot> bodies;
};

// Throws std::runtime_error if the frame does not fit the geometry.
Snapshot SnapshotOf(const v1::Geometry& geometry, const v1::Frame& frame);

// A column of values: of a component of a field.
struct SampledColumn {
  std::string name;  // `cauchy_stress/xx`, `displacement/z`, `volume_ratio`
  std::string unit;
  std::vector<double> values;
};

// Values of all fields of the bodies at points [m], in the bodies at rest or deformed: nodal fields are interpolated
// within the element that contains a point, by its linear or quadratic shape functions; fields of elements are those of
// that element. NaN at points outside of all bodies and of fields that a body does not have. Bodies that are surfaces
// have no inside.
std::vector<SampledColumn> SampleAtPoints(const Snapshot& snapshot, const std::vector<Vec3>& points, bool deformed);

// A field over a region: over the elements all of whose nodes are in the region, weighted by their volume, or, if there
// are none, over such faces of the body's boundary, weighted by area (fields of elements are those of the element
// behind a face). Nodal fields are averaged over an element first: over its nodes, or by quadratic shape functions.
struct RegionStatistics {
  std::string name;  // as in SampledColumn
  std::string unit;
  double mean = 0, smallest = 0, largest = 0;
  double integral = 0;  // [unit m^3], or [unit m^2]
};
struct RegionSample {
  bool is_volume = false;  // otherwise a surface
  double size = 0;         // [m^3] or [m^2]
  std::vector<RegionStatistics> fields;
};
// Nothing if the region has neither an element nor a face.
//   region  its name, or BODY/NAME where several bodies have it
//   deformed  whether volumes and areas are those of the deformed body
// Throws std::runtime_error, with the regions that there are, if there is no such region or several.
std::optional<RegionSample> SampleRegion(const Snapshot& snapshot, const std::string& region, bool deformed);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_EXPORT_SAMPLE_H_
