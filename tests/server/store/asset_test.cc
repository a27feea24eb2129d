// Assets, for each store, and special cases of files.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "core/base/digest.h"
#include "server/store/store.h"
#include "tests/support/files.h"
#include "tests/support/store_samples.h"

namespace fascicle::server {
namespace {

namespace fs = std::filesystem;

std::string HexOf(const std::string& bytes) { return Hex(Sha256Of(bytes)); }

bool Put(Store& store, const std::string& digest, std::int64_t size, const std::string& bytes) {
  const std::unique_ptr<AssetStore::Upload> upload = store.BeginUpload(digest, size);
  upload->Write(std::string_view(bytes).substr(0, bytes.size() / 3));
  upload->Write(std::string_view(bytes).substr(bytes.size() / 3));
  return upload->Commit();
}

int CountFiles(const std::string& directory) {
  int count = 0;
  for (const auto& entry : fs::recursive_directory_iterator(directory)) count += entry.is_regular_file();
  return count;
}

class AssetContract : public ::testing::TestWithParam<bool> {
 protected:
  testing::TemporaryFolder directory_;
  std::unique_ptr<Store> store_ = GetParam() ? OpenSqliteStore(directory_.path()) : MakeMemoryStore();
};

TEST_P(AssetContract, KeepsWhatWasAnnounced) {
  for (std::size_t size : {0, 1, 100'000}) {
    const std::string bytes = SampleBytes(size, size);
    EXPECT_FALSE(store_->HasAsset(HexOf(bytes)));
    EXPECT_FALSE(store_->ReadAsset(HexOf(bytes)).has_value());
    EXPECT_TRUE(Put(*store_, HexOf(bytes), static_cast<std::int64_t>(size), bytes));
    EXPECT_TRUE(Put(*store_, HexOf(bytes), static_cast<std::int64_t>(size), bytes));  // again
    EXPECT_TRUE(store_->HasAsset(HexOf(bytes)));
    EXPECT_EQ(store_->ReadAsset(HexOf(bytes)), bytes);
  }
}

TEST_P(AssetContract, RefusesWhatWasNotAnnounced) {
  const std::string bytes = SampleBytes(1, 1000);
  EXPECT_FALSE(Put(*store_, HexOf("other"), 1000, bytes));
  EXPECT_FALSE(Put(*store_, HexOf(bytes), 999, bytes));
  EXPECT_FALSE(Put(*store_, HexOf(bytes), 1001, bytes));
  EXPECT_FALSE(store_->HasAsset(HexOf(bytes)));
  EXPECT_FALSE(store_->HasAsset(HexOf("other")));
}

TEST_P(AssetContract, TakesNothingButADigestForAName) {
  const std::string bytes = "text";
  const std::string upper = [&] {
    std::string hex = HexOf(bytes);
    for (char& c : hex) c = static_cast<char>(std::toupper(c));
    return hex;
  }();
  for (const std::string& name : {std::string(), std::string("../../../etc/passwd"), std::string("../control.db"),
                                  upper, HexOf(bytes).substr(1), HexOf(bytes) + "0"}) {
    EXPECT_FALSE(Put(*store_, name, 4, bytes)) << name;
    EXPECT_FALSE(store_->HasAsset(name)) << name;
    EXPECT_FALSE(store_->ReadAsset(name).has_value()) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(Stores, AssetContract, ::testing::Bool(),
                         [](const auto& test) { return test.param ? "Sqlite" : "Memory"; });

TEST(AssetFiles, AreLeftByCommitAlone) {
  testing::TemporaryFolder directory;
  const std::string assets = directory / "assets";
  const std::unique_ptr<Store> store = OpenSqliteStore(directory.path());
  const std::string bytes = SampleBytes(3, 10'000);
  store->BeginUpload(HexOf(bytes), 10'000)->Write(bytes);
  EXPECT_EQ(CountFiles(assets), 0);
  Put(*store, HexOf("other"), 10'000, bytes);
  EXPECT_EQ(CountFiles(assets), 0);
  Put(*store, HexOf(bytes), 10'000, bytes);
  EXPECT_EQ(CountFiles(assets), 1);
  EXPECT_TRUE(fs::exists(assets + "/" + HexOf(bytes).substr(0, 2) + "/" + HexOf(bytes)));
}

TEST(AssetFiles, WriteNoMoreThanAnnounced) {
  testing::TemporaryFolder directory;
  const std::unique_ptr<Store> store = OpenSqliteStore(directory.path());
  const std::unique_ptr<AssetStore::Upload> upload = store->BeginUpload(HexOf(""), 1000);
  for (int i = 0; i < 100; ++i) upload->Write(SampleBytes(1, 1000));
  ASSERT_EQ(CountFiles(directory / "assets/uploads"), 1);
  EXPECT_LE(fs::directory_iterator(directory / "assets/uploads")->file_size(), 1000u);
}

TEST(AssetFiles, OfInterruptedUploadsAreRemovedAndOthersSurvive) {
  testing::TemporaryFolder directory;
  const std::string bytes = SampleBytes(4, 500);
  { Put(*OpenSqliteStore(directory.path()), HexOf(bytes), 500, bytes); }
  std::ofstream(directory / "assets/uploads/17") << "half";
  const std::unique_ptr<Store> store = OpenSqliteStore(directory.path());
  EXPECT_EQ(CountFiles(directory / "assets"), 1);
  EXPECT_EQ(store->ReadAsset(HexOf(bytes)), bytes);
}

TEST(AssetFiles, ThatAreDamagedAreToldByName) {
  testing::TemporaryFolder directory;
  const std::unique_ptr<Store> store = OpenSqliteStore(directory.path());
  const std::string bytes = SampleBytes(5, 500);
  Put(*store, HexOf(bytes), 500, bytes);
  const std::string path = directory / "assets/" + HexOf(bytes).substr(0, 2) + "/" + HexOf(bytes);
  {
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(77);
    file.put(static_cast<char>(bytes[77] ^ 1));
  }
  EXPECT_NE(ErrorOf([&] { store->ReadAsset(HexOf(bytes)); }).find(path), std::string::npos);
}

}  // namespace
}  // namespace fascicle::server
