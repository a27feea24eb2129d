#ifndef FASCICLE_SERVER_STORE_JOB_FILE_H_
#define FASCICLE_SERVER_STORE_JOB_FILE_H_

#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "server/store/store.h"

namespace fascicle::server {

// A whole job in one SQLite file, to be taken to another server: application_id "FSCJ", format in user_version. Tables:
//   contents  number of parts of the job, of chunks of the geometry, and of frames
//   job       the job's description in parts of at most 1 MiB, opaque here
//   geometry  chunks of at most 1 MiB
//   frames    as in jobs/{id}.db
//   chunks    of the frames, all in one sequence
// Every row has the checksum of its other columns (row_checksum.h).

// Writes the first `count` frames and the geometry to a new file. `go_on` is asked before each frame; Stopped is thrown
// if it says no. Throws StoreError.
void WriteJobFile(const std::string& path, std::string_view job, FrameStore& frames, std::int64_t count,
                  const std::function<bool()>& go_on);

// The file is not one of this kind, or is damaged; `what` is for users.
class JobFileError : public std::exception {
 public:
  explicit JobFileError(std::string what) : what_(std::move(what)) {}
  const char* what() const noexcept override { return what_.c_str(); }

 private:
  std::string what_;
};

// Reads such a file, which may come from anyone: nothing in it is run, each row is compared with its checksum, and not
// more is read than the file has bytes. All functions throw JobFileError. Not thread-safe.
class JobFileReader {
 public:
  static constexpr std::int64_t kMostJob = std::int64_t{8} << 20;      // description [byte]
  static constexpr std::int64_t kMostFrame = std::int64_t{512} << 20;  // frame or geometry [byte]

  explicit JobFileReader(const std::string& path);
  ~JobFileReader();

  std::string ReadJob();
  std::string ReadGeometry();
  std::int64_t frame_count() const;

  struct StoredFrame {
    FrameRecord record;
    std::string bytes;
  };
  // The next frame, from 0 on; there must be one.
  StoredFrame ReadNextFrame();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_STORE_JOB_FILE_H_
