// Everything that clients do, for a long time: memory and files do not grow. FASCICLE_SOAK_SECONDS is the duration, 300
// by default. A control with clients that leave more and more behind shows that growth would be seen.
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <thread>

#include "tests/support/files.h"
#include "tests/support/server_process.h"
#include "tests/support/service_fixture.h"

namespace fascicle::service_test {
namespace {

using fascicle::testing::ServerProcess;
using fascicle::testing::TemporaryFolder;

std::chrono::seconds Span() {
  const char* number = std::getenv("FASCICLE_SOAK_SECONDS");
  return std::chrono::seconds(number != nullptr ? std::max(20, std::atoi(number)) : 300);
}

// Resident memory over time.
class Growth {
 public:
  void Add(double seconds, std::int64_t bytes) { samples_.emplace_back(seconds, static_cast<double>(bytes)); }
  // The slope of a straight line through the samples of the last two thirds [byte/s].
  double Slope() const {
    double n = 0, t = 0, b = 0, tt = 0, tb = 0;
    for (std::size_t i = samples_.size() / 3; i < samples_.size(); ++i) {
      const auto [seconds, bytes] = samples_[i];
      n += 1, t += seconds, b += bytes, tt += seconds * seconds, tb += seconds * bytes;
    }
    return n < 3 ? 0 : (n * tb - t * b) / (n * tt - t * t);
  }
  // Growth from the first third to the end along that line [byte].
  double Amount() const { return samples_.empty() ? 0 : Slope() * samples_.back().first * 2 / 3; }

 private:
  std::vector<std::pair<double, double>> samples_;
};

// The largest write-ahead log of a data folder [byte].
std::int64_t LargestWal(const std::filesystem::path& data) {
  std::int64_t largest = 0;
  std::error_code error;
  for (auto file = std::filesystem::recursive_directory_iterator(data, error);
       !error && file != std::filesystem::recursive_directory_iterator(); file.increment(error)) {
    if (!file->path().string().ends_with("-wal")) continue;
    const std::uintmax_t size = file->file_size(error);
    if (!error) largest = std::max(largest, static_cast<std::int64_t>(size));
    error.clear();
  }
  return largest;
}

class SoakTest : public ::testing::Test {
 protected:
  void SetUp() override {
    address_ = server_.AwaitAddress();
    ASSERT_NE(address_, "");
  }

  // One client: submits, watches, cuts, cancels, uploads, lists and deletes, at random.
  void Use(unsigned seed) {
    std::mt19937 random(seed);
    std::optional<Stubs> stubs(address_);
    std::vector<std::string> mine;
    while (!stop_) {
      if (random() % 50 == 0) stubs.emplace(address_);  // another connection
      switch (random() % 8) {
        case 0:
        case 1:
          if (mine.size() < 8)
            mine.push_back(stubs->Submit(random() % 10 == 0 ? LargeSteps(40) : SwingingBox(0.05, 0.01)));
          break;
        case 2:
        case 3: {
          if (mine.empty()) break;
          const std::size_t most = random() % 3 == 0 ? 2 : 1000;
          ReadStream(*stubs, AllFramesOf(mine[random() % mine.size()]),
                     [&](const StreamRecord& record) { return record.frames.size() < most && !stop_; });
          break;
        }
        case 4:
          if (!mine.empty() && random() % 3 == 0) stubs->Cancel(mine[random() % mine.size()]);
          break;
        case 5: {
          grpc::ClientContext context;
          v1::ListJobsResponse list;
          EXPECT_TRUE(stubs->jobs->ListJobs(&context, {}, &list).ok());
          break;
        }
        case 6:
          Upload(*stubs, std::string(1 + random() % 200'000, static_cast<char>(random() % 4)));
          break;
        default:
          if (!mine.empty()) Delete(*stubs, mine, random() % mine.size());
      }
      ++actions_;
    }
  }

  void Measure(std::chrono::seconds span) {
    const auto start = std::chrono::steady_clock::now();
    while (std::chrono::steady_clock::now() - start < span) {
      std::this_thread::sleep_for(1s);
      growth_.Add(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
                  server_.ResidentBytes());
      wal_ = std::max(wal_, LargestWal(data_.path()));
    }
  }
  void Print(const char* what) {
    std::printf("%s: %lld actions, memory %lld MiB growing by %.2f KiB/s (%.1f MiB in all), WAL %lld KiB at most\n",
                what, static_cast<long long>(actions_), static_cast<long long>(server_.ResidentBytes() >> 20),
                growth_.Slope() / 1024, growth_.Amount() / (1 << 20), static_cast<long long>(wal_ >> 10));
  }

  static constexpr double kMostGrowth = 16 << 20;  // [byte]

  TemporaryFolder data_;
  ServerProcess server_{{"--listen", "127.0.0.1:0", "--data", data_.path(), "--log-level", "warn"}};
  std::string address_;
  std::atomic<bool> stop_ = false;
  std::atomic<std::int64_t> actions_ = 0;
  Growth growth_;
  std::int64_t wal_ = 0;

 private:
  static void Upload(Stubs& stubs, const std::string& bytes) {
    grpc::ClientContext context;
    v1::UploadAssetResponse response;
    const auto writer = stubs.assets->UploadAsset(&context, &response);
    v1::UploadAssetRequest request;
    request.set_name("assets/" + Hex(Sha256Of(bytes)));
    request.set_size(static_cast<std::int64_t>(bytes.size()));
    request.set_data(bytes);
    writer->Write(request);
    writer->WritesDone();
    EXPECT_TRUE(writer->Finish().ok());
  }
  // If it has ended.
  static void Delete(Stubs& stubs, std::vector<std::string>& jobs, std::size_t which) {
    grpc::ClientContext context;
    v1::DeleteJobRequest request;
    request.set_name(jobs[which]);
    google::protobuf::Empty nothing;
    if (!stubs.jobs->DeleteJob(&context, request, &nothing).ok()) return;
    jobs.erase(jobs.begin() + static_cast<std::ptrdiff_t>(which));
  }
};

TEST_F(SoakTest, NothingGrows) {
  std::vector<std::thread> clients;
  for (unsigned i = 0; i < 8; ++i) clients.emplace_back([this, i] { Use(i); });
  Measure(Span());
  stop_ = true;
  for (std::thread& client : clients) client.join();
  Print("soak");
  EXPECT_GT(actions_, 100);
  EXPECT_LE(growth_.Amount(), kMostGrowth);
  EXPECT_LE(wal_, 64 << 20);
}

TEST_F(SoakTest, GrowthWouldBeSeen) {
  Stubs stubs(address_);
  v1::Scene scene = LargeFrames(2);  // with a geometry that the buffers of a connection can't hold
  for (int i = 0; i < 3; ++i) scene.mutable_bodies(0)->mutable_mesh()->mutable_box()->set_divisions(i, 40);
  const std::string job = stubs.Submit(scene);
  ASSERT_TRUE(stubs.AwaitState(job, v1::Job::STATE_SUCCEEDED, 120s));
  // Readers of the geometry that never read; those of frames would share what waits for them.
  struct Left {
    explicit Left(const std::string& address) : stubs(address) {}
    ~Left() {
      context.TryCancel();
      reader->Finish();
    }
    Stubs stubs;
    grpc::ClientContext context;
    std::unique_ptr<grpc::ClientReader<v1::GetGeometryResponse>> reader;
  };
  std::vector<std::unique_ptr<Left>> left;
  std::thread client([&] {
    v1::GetGeometryRequest request;
    request.set_name(job);
    while (!stop_) {
      Left& one = *left.emplace_back(std::make_unique<Left>(address_));
      one.reader = one.stubs.frames->GetGeometry(&one.context, request);
      ++actions_;
      std::this_thread::sleep_for(200ms);
    }
  });
  Measure(20s);
  stop_ = true;
  client.join();
  Print("control");
  EXPECT_GT(growth_.Amount(), kMostGrowth);
}

}  // namespace
}  // namespace fascicle::service_test
