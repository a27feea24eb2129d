// The cache of results, in memory and as files, and special cases of files.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include "core/base/digest.h"
#include "server/store/result_store.h"
#include "server/store/store.h"
#include "tests/support/files.h"
#include "tests/support/store_samples.h"

namespace fascicle::server {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kLarge = 1 << 20;

std::string KeyOf(int number) { return Hex(Sha256Of("input " + std::to_string(number))); }

// `size` bytes that depend on `number`.
std::string BytesOf(int number, std::size_t size = 100'000) { return SampleBytes(static_cast<unsigned>(number), size); }

class ResultContract : public ::testing::TestWithParam<bool> {
 protected:
  std::unique_ptr<ResultStore> Open(std::int64_t most_bytes) const {
    return GetParam() ? OpenResultDirectory(directory_.path().string(), most_bytes) : MakeMemoryResults(most_bytes);
  }

  testing::TemporaryFolder directory_;
};

TEST_P(ResultContract, GivesBackWhatWasPut) {
  const auto results = Open(kLarge);
  for (const std::size_t size : {0, 1, 100'000}) {
    const std::string bytes = BytesOf(1, size);
    results->PutResult(KeyOf(1), bytes);  // replaces the previous one
    EXPECT_EQ(results->GetResult(KeyOf(1)), bytes);
  }
  EXPECT_EQ(results->GetResult(KeyOf(2)), std::nullopt);
}

TEST_P(ResultContract, TakesNothingButADigestForAKey) {
  const auto results = Open(kLarge);
  for (const std::string& key : {std::string(), std::string("../key"), std::string(64, 'A'), std::string(63, 'a')}) {
    results->PutResult(key, "bytes");
    EXPECT_EQ(results->GetResult(key), std::nullopt);
  }
}

TEST_P(ResultContract, RemovesTheEntriesUsedLongestAgo) {
  const auto results = Open(350'000);
  for (int i = 0; i < 3; ++i) results->PutResult(KeyOf(i), BytesOf(i));
  EXPECT_TRUE(results->GetResult(KeyOf(0)));
  results->PutResult(KeyOf(3), BytesOf(3));  // removes 1
  EXPECT_EQ(results->GetResult(KeyOf(1)), std::nullopt);
  for (const int i : {0, 2, 3}) EXPECT_EQ(results->GetResult(KeyOf(i)), BytesOf(i)) << i;
  results->PutResult(KeyOf(4), BytesOf(4, 200'000));  // removes 0 and 2
  EXPECT_EQ(results->GetResult(KeyOf(0)), std::nullopt);
  EXPECT_EQ(results->GetResult(KeyOf(2)), std::nullopt);
  EXPECT_TRUE(results->GetResult(KeyOf(3)));
  EXPECT_TRUE(results->GetResult(KeyOf(4)));
}

TEST_P(ResultContract, AnEntryThatIsReplacedCountsOnce) {
  const auto results = Open(250'000);
  results->PutResult(KeyOf(0), BytesOf(0));
  for (int i = 0; i < 5; ++i) results->PutResult(KeyOf(1), BytesOf(i));
  EXPECT_EQ(results->GetResult(KeyOf(0)), BytesOf(0));
}

TEST_P(ResultContract, WhatIsTooLargeLeavesTheRest) {
  const auto results = Open(250'000);
  results->PutResult(KeyOf(0), BytesOf(0));
  results->PutResult(KeyOf(1), BytesOf(1, 300'000));
  EXPECT_EQ(results->GetResult(KeyOf(1)), std::nullopt);
  EXPECT_TRUE(results->GetResult(KeyOf(0)));
}

TEST_P(ResultContract, SmallEntriesCountAsTheLeastSize) {
  const auto results = Open(3 * ResultStore::kLeastSize);
  for (int i = 0; i < 4; ++i) results->PutResult(KeyOf(i), "x");
  EXPECT_EQ(results->GetResult(KeyOf(0)), std::nullopt);
  for (int i = 1; i < 4; ++i) EXPECT_EQ(results->GetResult(KeyOf(i)), "x");
}

TEST_P(ResultContract, OfNoBytesKeepsNothing) {
  const auto results = Open(0);
  results->PutResult(KeyOf(0), "x");
  EXPECT_EQ(results->GetResult(KeyOf(0)), std::nullopt);
}

TEST_P(ResultContract, SeveralThreadsPutAndGet) {
  const auto results = Open(500'000);
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      for (int i = 0; i < 200; ++i) {
        const int number = (i + 3 * t) % 10;
        const std::optional<std::string> bytes = results->GetResult(KeyOf(number));
        EXPECT_EQ(bytes.value_or(BytesOf(number)), BytesOf(number));
        results->PutResult(KeyOf(number), BytesOf(number));
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
}

INSTANTIATE_TEST_SUITE_P(Results, ResultContract, ::testing::Values(false, true),
                         [](const auto& kind) { return kind.param ? "Directory" : "Memory"; });

class ResultDirectoryTest : public ::testing::Test {
 protected:
  std::unique_ptr<ResultStore> Open(std::int64_t most_bytes = kLarge) const {
    return OpenResultDirectory(directory_.path().string(), most_bytes);
  }
  std::string PathOf(int number) const { return directory_ / KeyOf(number); }
  int Files() const {
    const auto entries = fs::directory_iterator(directory_.path());
    return static_cast<int>(std::distance(begin(entries), end(entries)));
  }

  testing::TemporaryFolder directory_;
};

TEST_F(ResultDirectoryTest, EntriesAreThereAgain) {
  Open()->PutResult(KeyOf(1), BytesOf(1));
  EXPECT_EQ(Open()->GetResult(KeyOf(1)), BytesOf(1));
}

TEST_F(ResultDirectoryTest, TheOrderOfUseIsKept) {
  {
    const auto results = Open();
    for (int i = 0; i < 3; ++i) results->PutResult(KeyOf(i), BytesOf(i));
    EXPECT_TRUE(results->GetResult(KeyOf(0)));
  }
  const auto smaller = Open(250'000);
  EXPECT_EQ(Files(), 2);
  EXPECT_EQ(smaller->GetResult(KeyOf(1)), std::nullopt);
  EXPECT_TRUE(smaller->GetResult(KeyOf(0)));
  EXPECT_TRUE(smaller->GetResult(KeyOf(2)));
}

// With any byte changed or any end truncated, the entry is lost and can be stored again.
TEST_F(ResultDirectoryTest, DamagedEntriesAreNone) {
  const std::string bytes = BytesOf(1, 50);
  const auto results = Open();
  const auto expect_none = [&](const std::string& file) {
    results->PutResult(KeyOf(1), bytes);
    std::ofstream(PathOf(1), std::ios::binary | std::ios::trunc) << file;
    EXPECT_EQ(results->GetResult(KeyOf(1)), std::nullopt) << file.size();
    EXPECT_EQ(Files(), 0);
    results->PutResult(KeyOf(1), bytes);
    EXPECT_EQ(results->GetResult(KeyOf(1)), bytes);
  };
  results->PutResult(KeyOf(1), bytes);
  std::ifstream in(PathOf(1), std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(in), {}};
  for (std::size_t at = 0; at < whole.size(); ++at) {
    expect_none(whole.substr(0, at));
    std::string changed = whole;
    changed[at] ^= 1;
    expect_none(changed);
  }
}

TEST_F(ResultDirectoryTest, WhatWasHalfWrittenIsRemoved) {
  std::ofstream(directory_ / "new-7") << "half";
  Open();
  EXPECT_EQ(Files(), 0);
}

TEST_F(ResultDirectoryTest, StorageThatFailsIsNoError) {
  const auto results = Open();
  fs::remove_all(directory_.path());
  results->PutResult(KeyOf(1), "bytes");
  EXPECT_EQ(results->GetResult(KeyOf(1)), std::nullopt);
}

TEST_F(ResultDirectoryTest, AFolderThatCannotBeMadeIsOne) {
  std::ofstream(directory_ / "file") << "x";
  EXPECT_THROW(OpenResultDirectory(directory_ / "file/results", kLarge), StoreError);
}

}  // namespace
}  // namespace fascicle::server
