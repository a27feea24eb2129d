// Acknowledged CreateJob calls of many clients over gRPC, compared with plain SQLite commits of the same durability
// (raw_sqlite.h) of the same specs.
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "ratio.h"
#include "raw_sqlite.h"
#include "tests/support/files.h"
#include "tests/support/service_fixture.h"

namespace fascicle::service_test {
namespace {

constexpr int kClients = 16;
constexpr int kSubmissions = 320;

v1::CreateJobRequest NextRequest(std::atomic<int>& number) {
  v1::CreateJobRequest request;
  *request.mutable_job()->mutable_scene() = SwingingBox(0.01, 0.01);
  request.set_request_id("request " + std::to_string(number++));
  return request;
}

void Run() {
  testing::TemporaryFolder directory;
  server::ServerOptions options;
  options.data_directory = directory.path().string();
  options.workers = 0;
  const auto server = server::EmbeddedServer::Start(options);
  std::vector<std::unique_ptr<Stubs>> clients;
  for (int i = 0; i < kClients; ++i) clients.push_back(std::make_unique<Stubs>(server->address()));
  bench::RawSqlite raw(directory / "raw.db");
  std::atomic<int> number = 0;
  const auto submit = [&](int count) {
    std::vector<std::thread> threads;
    for (int t = 0; t < count; ++t) {
      threads.emplace_back([&, t] {
        for (int i = 0; i < kSubmissions / count; ++i) {
          v1::Job job;
          if (!clients[static_cast<std::size_t>(t)]->Create(NextRequest(number), job).ok()) std::abort();
        }
      });
    }
    for (std::thread& thread : threads) thread.join();
  };
  const auto commit = [&] {
    for (int i = 0; i < kSubmissions; ++i) {
      const v1::CreateJobRequest request = NextRequest(number);
      raw.Insert(request.request_id(), request.request_id(), request.job().SerializeAsString());
    }
  };
  const auto submit_batches = [&](int size) {
    for (int begin = 0; begin < kSubmissions; begin += size) {
      v1::BatchCreateJobsRequest batch;
      for (int i = 0; i < size; ++i) *batch.add_requests() = NextRequest(number);
      grpc::ClientContext context;
      v1::BatchCreateJobsResponse created;
      if (!clients[0]->jobs->BatchCreateJobs(&context, batch, &created).ok()) std::abort();
    }
  };
  for (const int size : {4, 16, 64}) {
    std::printf("%d submissions: A over gRPC in batches of %d, B by raw SQLite\n", kSubmissions, size);
    bench::MedianRatio(
        "batch_vs_sqlite_" + std::to_string(size), 9, [&] { submit_batches(size); }, commit);
  }
  for (const int count : {1, 4, kClients}) {
    std::printf("%d submissions: A over gRPC with %d clients, B by raw SQLite\n", kSubmissions, count);
    bench::MedianRatio(
        "create_job_vs_sqlite_" + std::to_string(count), 9, [&] { submit(count); }, commit);
  }
}

}  // namespace
}  // namespace fascicle::service_test

int main() { fascicle::service_test::Run(); }
