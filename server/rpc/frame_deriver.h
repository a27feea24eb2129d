#ifndef FASCICLE_SERVER_RPC_FRAME_DERIVER_H_
#define FASCICLE_SERVER_RPC_FRAME_DERIVER_H_

#include <condition_variable>
#include <cstddef>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <set>
#include <string>

#include <spdlog/logger.h>

#include "server/rpc/executor.h"

namespace fascicle::server {

// Derived frames of all readers, made on two threads of their own, so that nothing else waits for them. Readers that
// want the same frame in the same form share it. Readers keep nothing but their place in a frame: what was used least
// recently is dropped, and made again for a reader that goes on later. Thread-safe.
class FrameDeriver {
 public:
  // `most_kept`: size of all frames kept [byte]; the last one is kept in any case.
  FrameDeriver(spdlog::logger& log, std::size_t most_kept);

  // Streams of derived frames are filled here.
  Executor& executor() { return executor_; }

  using Bytes = std::shared_ptr<const std::string>;
  // The bytes of `key`, which `make` makes unless they are kept. Equal keys must have equal bytes. Waits if another
  // thread makes them. Rethrows what `make` throws.
  Bytes Get(const std::string& key, const std::function<std::string()>& make);

 private:
  struct Entry {
    std::string key;
    Bytes bytes;
  };

  // The functions below need the lock.
  Bytes Find(const std::string& key);
  void Keep(const std::string& key, Bytes bytes);

  const std::size_t most_kept_;
  std::mutex mutex_;
  std::condition_variable made_;
  std::set<std::string> making_;
  std::list<Entry> kept_;  // the most recently used one first
  std::size_t size_ = 0;   // of all kept [byte]
  Executor executor_;      // destroyed first
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_FRAME_DERIVER_H_
