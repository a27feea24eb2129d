#ifndef FASCICLE_PROTO_FRAMES_FRAME_FITS_H_
#define FASCICLE_PROTO_FRAMES_FRAME_FITS_H_

#include "fascicle/v1/frame.pb.h"

namespace fascicle {

// Whether the frame has as many bodies, poses, lines and series as the geometry says.
bool FrameFits(const v1::Frame& frame, const v1::Geometry& geometry);

}  // namespace fascicle

#endif  // FASCICLE_PROTO_FRAMES_FRAME_FITS_H_
