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
  std::vector<std::vector<double>> bodies;   // one value for each node; empty of a body that has no colours
  std::vector<std::optional<double>> lines;  // nothing of a line that has no colour
  std::string title;                         // with the unit of the scale
  ColourScale scale;                         // without table when nothing is coloured
};

// Colours each frame by `name`, all on one scale: bodies that have such a field (see ValuesAtNodes), and lines that
// have such a value. Empty: nothing. `range`: the ends of the scale, in the field's unit; those of the values when
// absent. Throws std::runtime_error when no object has it, or when objects have it in different units.
std::vector<Colouring> ColourFrames(const std::vector<BodyShape>& bodies, const std::vector<LineInfo>& lines,
                                    std::span<const v1::Frame> frames, const std::string& name,
                                    const std::optional<std::pair<double, double>>& range);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_RENDER_COLOURING_H_
