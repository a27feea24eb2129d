#ifndef FASCICLE_SERVER_JOBS_FRAME_WRITER_H_
#define FASCICLE_SERVER_JOBS_FRAME_WRITER_H_

#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "core/sim/frame.h"
#include "core/sim/simulation.h"
#include "server/jobs/active_job.h"

namespace fascicle::server {

// Stores the frames of a run from a thread of its own. The solver continues while a frame is encoded and written, and
// waits only if kMaxWaiting frames are queued, as they are while the disk is full. Also stores progress, profile and
// the lines of the log, which are stored with the next frame at the latest, from time to time.
class FrameWriter final : public FrameSink {
 public:
  // `job` must have its frame store. `notify` is called after each stored frame. All arguments must outlive the writer.
  FrameWriter(class Store& store, ActiveJob& job, const JobCodec& codec, RunProfile& profile,
              std::function<void()> notify);
  // Finishes; errors are ignored.
  ~FrameWriter() override;

  bool PutFrame(Frame frame, std::string checkpoint) override;
  void PutProgress(const Progress& progress) override { job_.SetProgress(progress); }
  void PutLine(std::int64_t number, LogLine line) override;

  // Returns when every frame is stored. Throws the error of the first frame that could not be stored; Stopped if the
  // job was asked to stop while the disk was full.
  void Finish();

 private:
  static constexpr std::size_t kMaxWaiting = 3;

  struct NumberedLine {
    std::int64_t number = 0;
    LogLine line;
  };
  struct Item {
    Frame frame;
    std::string checkpoint;
    std::vector<NumberedLine> lines;  // before it
  };

  void Loop();
  void StoreFrame(const Item& item);
  bool IsStoredDifferently(const FrameRecord& record);
  std::string Encode(const Frame& frame);
  void Encode(const std::vector<NumberedLine>& lines);
  void StoreLines();
  void StoreProgressRarely();
  void Close();

  class Store& store_;
  ActiveJob& job_;
  const std::shared_ptr<FrameStore> frames_;
  const JobCodec& codec_;
  RunProfile& profile_;
  const std::function<void()> notify_;
  std::chrono::steady_clock::time_point next_progress_;  // used by the thread only, as is this:
  std::vector<LogRow> rows_;                             // lines to be stored

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Item> waiting_;
  std::vector<NumberedLine> lines_;  // since the last frame of waiting_
  bool is_closed_ = false;
  std::exception_ptr error_;
  std::thread thread_;
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_JOBS_FRAME_WRITER_H_
