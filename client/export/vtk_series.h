#ifndef FASCICLE_CLIENT_EXPORT_VTK_SERIES_H_
#define FASCICLE_CLIENT_EXPORT_VTK_SERIES_H_

#include <filesystem>
#include <string>
#include <vector>

#include "client/lib/decode.h"
#include "fascicle/v1/frame.pb.h"

namespace fascicle::client {

// Writes frames as a VTK series for ParaView and other programs. Each frame has a file for each body
// (frames/NAME_000000.vtu), each line (frames/line_NAME_000000.vtp) and each rigid body that moves
// (frames/rigid_NAME_000000.vtp). A rigid body that does not move has one file (frames/fixed_NAME.vtp); one without a
// shape has none. frames.pvd lists all with their times [s]. vtk_files.h describes their contents. Each file is
// complete or absent. Not thread-safe. Functions throw std::runtime_error with a message for users.
class VtkSeriesWriter {
 public:
  // Creates folders as needed. Files of an earlier series in `folder` are overwritten.
  VtkSeriesWriter(const v1::Geometry& geometry, std::filesystem::path folder);

  void Add(const v1::Frame& frame);
  // Writes frames.pvd, which lists all frames added so far.
  void Finish() const;

 private:
  struct Entry {
    double time;       // [s]
    std::size_t part;  // number of the object: bodies, then rigid bodies, then lines
    std::string name;  // of the object
    std::string file;  // relative to the folder
  };

  // Rigid bodies that do not move are written with the first frame.
  void AddRigidBodies(const v1::Frame& frame, bool first);
  void AddLines(const v1::Frame& frame);

  std::filesystem::path folder_;
  std::vector<BodyShape> bodies_;
  std::vector<RigidShape> rigid_bodies_;
  std::vector<LineInfo> lines_;
  std::vector<Entry> entries_;
};

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_EXPORT_VTK_SERIES_H_
