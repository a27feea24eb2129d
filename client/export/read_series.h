#ifndef FASCICLE_CLIENT_EXPORT_READ_SERIES_H_
#define FASCICLE_CLIENT_EXPORT_READ_SERIES_H_

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "client/export/sample.h"

namespace fascicle::client {

// A frame of an exported VTK series and the files of its bodies.
struct ExportedFrame {
  std::int64_t frame = 0;
  double time = 0;  // [s]
  struct Body {
    std::string name;
    std::filesystem::path file;
  };
  std::vector<Body> bodies;
};

// Whether the folder has a series as VtkSeriesWriter writes it.
bool HasSeries(const std::filesystem::path& folder);

// The frames of such a series, in order; lines and rigid bodies are left out. Throws std::runtime_error with a message
// for users.
std::vector<ExportedFrame> ReadSeriesIndex(const std::filesystem::path& folder);

// The bodies of a frame, as they were exported. Throws std::runtime_error with a message for users.
Snapshot ReadSnapshot(const ExportedFrame& frame);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_EXPORT_READ_SERIES_H_
