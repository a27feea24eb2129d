#ifndef FASCICLE_CLIENT_RENDER_FIELD_VALUES_H_
#define FASCICLE_CLIENT_RENDER_FIELD_VALUES_H_

#include <string>
#include <vector>

#include "client/lib/decode.h"
#include "fascicle/v1/frame.pb.h"

namespace fascicle::client {

// The values that colour a body, one for each node.
struct NodeValues {
  std::vector<double> values;
  std::string title;  // `von_mises_stress`, `displacement z`
  std::string unit;
};

// Values of `field` for colouring: `displacement`, the name of a field of the frame, or NAME/COMPONENT such as
// `displacement/z`, `cauchy_stress/xx`, `principal_strains/1`. A vector without a component gives its magnitude; values
// of elements are averaged to nodes by rest volume. Throws std::runtime_error that lists the existing fields.
NodeValues ValuesAtNodes(const BodyShape& shape, const v1::BodyFrame& frame, const std::string& field);

// Whether ValuesAtNodes finds such a field, with any component.
bool HasField(const v1::BodyFrame& frame, const std::string& field);
// The existing fields, separated by commas.
std::string FieldNames(const v1::BodyFrame& frame);

// Unit fibre directions in the deformed body at the nodes, averaged as lines (a and -a are the same); zero where there
// are none.
std::vector<Vec3> FibresAtNodes(const BodyShape& shape, const std::vector<Vec3>& positions);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_RENDER_FIELD_VALUES_H_
