#ifndef FASCICLE_CLIENT_EXPORT_VTK_SERIES_H_
#define FASCICLE_CLIENT_EXPORT_VTK_SERIES_H_

#include <filesystem>
#include <string>
#include <vector>

#include "client/lib/decode.h"
#include "fascicle/v1/frame.pb.h"

namespace fascicle::client {

// Writes frames as a VTK series for ParaView and other programs: one .vtu for each body and frame (binary, appended,
// zlib), and frames.pvd with their times [s]. Nodes have `displacement` [m], the frame's node fields and a flag for
// each region; elements have the frame's element fields and `rest_fibre`. Each file is complete or absent. Not
// thread-safe. Functions throw std::runtime_error with a message for users.
class VtkSeriesWriter {
 public:
  // Creates folders as needed. Files of an earlier series in `folder` are overwritten.
  VtkSeriesWriter(const v1::Geometry& geometry, std::filesystem::path folder);

  void Add(const v1::Frame& frame);
  // Writes frames.pvd, which lists all frames added so far.
  void Finish() const;

 private:
  struct Entry {
    double time;  // [s]
    std::size_t body;
    std::string file;  // relative to the folder
  };
  std::filesystem::path folder_;
  std::vector<BodyShape> shapes_;
  std::vector<Entry> entries_;
};

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_EXPORT_VTK_SERIES_H_
