// Writing and reading frames of the store, and acknowledged submissions by several clients compared with plain SQLite
// commits of the same durability (WAL, synchronous FULL, one row and one commit each, one connection).
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "ratio.h"
#include "raw_sqlite.h"
#include "server/store/store.h"
#include "tests/support/files.h"
#include "tests/support/store_samples.h"

namespace fascicle::server {
namespace {

constexpr int kClients = 16;
constexpr int kSubmissions = 320;

void WriteAndReadFrames() {
  constexpr int kFrames = 24;
  constexpr std::size_t kFrameSize = 4 * FrameStore::kChunkSize;
  testing::TemporaryFolder directory;
  const std::unique_ptr<Store> store = OpenSqliteStore(directory.path());
  JobRecord existing;
  store->CreateJob(SampleJob(1), &existing);
  const std::shared_ptr<FrameStore> frames = store->OpenFrames(SampleJob(1).id);
  const std::string bytes = SampleBytes(1, kFrameSize);
  std::vector<double> writes;
  for (int i = 0; i < kFrames; ++i) {
    const FrameRecord record = MakeSampleFrame(i, 1).record;
    writes.push_back(bench::SecondsOf([&] { frames->PutFrame(record, bytes, ""); }));
  }
  std::printf("frame write %.0f MB/s (4 MiB each, durable)\n", 1e-6 * kFrameSize / bench::Median(writes));

  std::vector<double> reads;
  std::size_t read = 0;
  for (int round = 0; round < 10; ++round) {
    reads.push_back(bench::SecondsOf([&] {
      for (int i = 0; i < kFrames; ++i) {
        for (int chunk = 0; chunk < 4; ++chunk) read += frames->ReadChunk(i, chunk)->size();
      }
    }));
  }
  if (read != reads.size() * kFrames * kFrameSize) std::abort();
  std::printf("chunk read %.2f GB/s (1 MiB each, one thread)\n", 1e-9 * kFrames * kFrameSize / bench::Median(reads));
}

JobRecord NextJob(std::atomic<int>& number) {
  JobRecord job = SampleJob(number++);
  job.request_id = job.id;
  return job;
}

void CompareSubmissions() {
  testing::TemporaryFolder directory;
  const std::unique_ptr<Store> store = OpenSqliteStore(directory.path());
  bench::RawSqlite raw(directory / "raw.db");
  std::atomic<int> number = 0;
  const auto submit = [&](int clients) {
    std::vector<std::thread> threads;
    for (int t = 0; t < clients; ++t) {
      threads.emplace_back([&, count = kSubmissions / clients] {
        for (int i = 0; i < count; ++i) {
          JobRecord existing;
          if (!store->CreateJob(NextJob(number), &existing)) std::abort();
        }
      });
    }
    for (std::thread& thread : threads) thread.join();
  };
  const auto commit = [&] {
    for (int i = 0; i < kSubmissions; ++i) {
      const JobRecord job = NextJob(number);
      raw.Insert(job.id, job.request_id, job.spec);
    }
  };
  std::printf("%d submissions: A by the store with one client, B by raw SQLite\n", kSubmissions);
  bench::MedianRatio(
      "submit_one_client_vs_sqlite", 9, [&] { submit(1); }, commit);
  std::printf("%d submissions: A by the store with %d clients, B by raw SQLite\n", kSubmissions, kClients);
  bench::MedianRatio(
      "submit_vs_sqlite", 9, [&] { submit(kClients); }, commit);
}

}  // namespace
}  // namespace fascicle::server

int main() {
  fascicle::server::WriteAndReadFrames();
  fascicle::server::CompareSubmissions();
}
