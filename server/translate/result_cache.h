#ifndef FASCICLE_SERVER_TRANSLATE_RESULT_CACHE_H_
#define FASCICLE_SERVER_TRANSLATE_RESULT_CACHE_H_

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <stop_token>
#include <string>
#include <utility>

#include "core/base/archive.h"
#include "server/store/result_store.h"

namespace fascicle::server {

// Results of stages that take long, such as a segmented image, for later use: by the worker that runs the scene after
// its check, or by another scene with the same scan. A result is a function of the data in its key, and is returned
// with the same bits. Thread-safe.
class ResultCache {
 public:
  // `store` must outlive the cache.
  explicit ResultCache(ResultStore& store) : store_(store) {}
  ResultCache(const ResultCache&) = delete;
  ResultCache& operator=(const ResultCache&) = delete;

  // The result kept for these inputs, or that of compute() -> std::optional<Result>, which is then kept. If compute
  // returns nothing, nothing is kept. If several threads ask for the same result at once, one of them computes it.
  // Throws what compute throws, and Stopped after a stop request while it waits for another thread.
  //   inputs  everything that the result depends on, as an archive with the kind and version of the stage
  //   Result  has WriteTo(ArchiveWriter&) const and ReadFrom(ArchiveReader&)
  template <class Result, class Compute>
  std::optional<Result> GetOrCompute(ArchiveWriter inputs, const std::stop_token& stop, const Compute& compute) {
    const std::string key = KeyOf(std::move(inputs));
    const std::shared_ptr<void> claim = Claim(key, stop);
    if (const std::optional<std::string> bytes = store_.GetResult(key)) {
      ArchiveReader archive(*bytes, kKind, kVersion);
      Result result;
      result.ReadFrom(archive);
      if (archive.AtEnd()) return result;
    }
    std::optional<Result> result = compute();
    if (result) {
      ArchiveWriter archive(kKind, kVersion);
      result->WriteTo(archive);
      store_.PutResult(key, archive.Finish());
    }
    return result;
  }

 private:
  static constexpr const char* kKind = "result";
  static constexpr std::uint32_t kVersion = 1;

  // The digest of the inputs and of the program's version, since another version may compute a different result.
  static std::string KeyOf(ArchiveWriter inputs);
  // Waits until no other thread holds the key; the returned pointer releases it.
  std::shared_ptr<void> Claim(const std::string& key, const std::stop_token& stop);

  ResultStore& store_;
  std::mutex mutex_;
  std::condition_variable_any released_;
  std::set<std::string> claimed_;  // guarded by mutex_
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_RESULT_CACHE_H_
