#ifndef FASCICLE_CLIENT_RENDER_COLOURING_H_
#define FASCICLE_CLIENT_RENDER_COLOURING_H_

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "client/lib/decode.h"
#include "client/render/colour_scale.h"
#include "fascicle/v1/frame.pb.h"

namespace fascicle::client {

// The colours of one frame.
struct Colouring {
  std::vector<std::vector<double>> bodies;   // one value for each node; empty if the body is not coloured
  std::vector<std::optional<double>> lines;  // nothing if the line is not coloured
  std::string title;                         // with its unit
  std::string note;                          // on values beyond the scale; mostly empty
  ColourScale scale;                         // without a table if nothing is coloured
};

// Colours each frame by `name`, all on one scale: bodies with such a field (see ValuesAtNodes), or with one colour if
// there is a series BODY/`name` such as `biceps/activation`, and lines with such a value. Nothing is coloured if it is
// empty. `range`: the ends of the scale, in the field's unit. If absent, those of the values; or their first and last
// percentiles where a few values are so far off that the others would have nearly one colour, which the note says.
// Throws std::runtime_error if no object has it, or if objects have it in different units.
std::vector<Colouring> ColourFrames(const std::vector<BodyShape>& bodies, const std::vector<LineInfo>& lines,
                                    const google::protobuf::RepeatedPtrField<v1::SeriesInfo>& series,
                                    std::span<const v1::Frame> frames, const std::string& name,
                                    const std::optional<std::pair<double, double>>& range);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_RENDER_COLOURING_H_
