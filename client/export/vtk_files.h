#ifndef FASCICLE_CLIENT_EXPORT_VTK_FILES_H_
#define FASCICLE_CLIENT_EXPORT_VTK_FILES_H_

#include <filesystem>

#include "client/lib/decode.h"
#include "fascicle/v1/frame.pb.h"

namespace fascicle::client {

// One object at one time as a VTK XML file (binary, appended, zlib), which is complete or absent. Functions throw
// std::runtime_error with a message for users.

// .vtu, with quadratic cells if the body has mid-edge nodes: nodes have `displacement` [m], the frame's node fields and
// a flag for each region; elements have the frame's element fields and `rest_fibre`.
void WriteBody(const BodyShape& shape, const v1::BodyFrame& frame, const std::filesystem::path& path);

// .vtp: the triangles in the body's pose.
void WriteRigidBody(const RigidShape& body, const Pose& pose, const std::filesystem::path& path);

// .vtp: one polyline with the line's values; only points if there are fewer than two.
void WriteLine(const LineInfo& line, const LinePath& state, const std::filesystem::path& path);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_EXPORT_VTK_FILES_H_
