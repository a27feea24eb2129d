// The layer over SQLite, and migration of files from one format to the next.
#include "server/store/database.h"

#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>

#include "server/store/file_system.h"
#include "server/store/store.h"
#include "tests/support/files.h"
#include "tests/support/store_samples.h"

namespace fascicle::server {
namespace {

namespace fs = std::filesystem;

constexpr int kId = 4711;
constexpr const char* kCreate = "CREATE TABLE notes (text TEXT NOT NULL)";
constexpr const char* kAddSize = "ALTER TABLE notes ADD COLUMN size INTEGER NOT NULL DEFAULT 7";
constexpr std::array<const char*, 1> kOld = {kCreate};
constexpr std::array<const char*, 2> kNew = {kCreate, kAddSize};
constexpr std::array<const char*, 2> kBroken = {kCreate, "ALTER TABLE notes ADD COLUMN size INTEGER; CREATE nonsense"};

class DatabaseTest : public ::testing::Test {
 protected:
  testing::TemporaryFolder directory_;
  const std::string path_ = directory_ / "notes.db";
  const std::string backup_ = path_ + ".format-1.backup";
};

TEST_F(DatabaseTest, IsDurableByItsSettings) {
  Database database = OpenFormatted(path_, kId, kOld);
  EXPECT_EQ(database.QueryInt("PRAGMA synchronous"), 2);  // FULL
  EXPECT_EQ(database.QueryInt("PRAGMA foreign_keys"), 1);
  EXPECT_EQ(database.QueryInt("PRAGMA journal_size_limit"), 64 << 20);
  Statement mode = database.Prepare("PRAGMA journal_mode");
  Rows rows = mode.Query();
  ASSERT_TRUE(rows.Next());
  EXPECT_EQ(rows.String(0), "wal");
}

TEST_F(DatabaseTest, BindsAndReadsEveryType) {
  Database database = OpenFormatted(path_, kId, kOld);
  Statement echo = database.Prepare("SELECT ?, ?, ?, ?, ?");
  const std::string blob("a\0b", 3);
  Rows rows = echo.Query(std::int64_t{1} << 40, -2.5, "text", Blob{blob}, nullptr);
  ASSERT_TRUE(rows.Next());
  EXPECT_EQ(rows.Int(0), std::int64_t{1} << 40);
  EXPECT_EQ(rows.Real(1), -2.5);
  EXPECT_EQ(rows.String(2), "text");
  EXPECT_EQ(rows.String(3), blob);
  EXPECT_EQ(rows.String(4), "");
  EXPECT_FALSE(rows.Next());
}

TEST_F(DatabaseTest, RollsBackWhatIsNotCommitted) {
  Database database = OpenFormatted(path_, kId, kOld);
  {
    Transaction transaction(database);
    database.Execute("INSERT INTO notes VALUES ('lost')");
  }
  EXPECT_EQ(database.QueryInt("SELECT count(*) FROM notes"), 0);
}

TEST_F(DatabaseTest, ReadOnlyRefusesChanges) {
  OpenFormatted(path_, kId, kOld);
  Database reader(path_, Database::Mode::kReadOnly);
  EXPECT_NE(ErrorOf([&] { reader.Execute("INSERT INTO notes VALUES ('x')"); }), "");
}

TEST_F(DatabaseTest, UpgradesAnOldFormatAndLeavesACopy) {
  { OpenFormatted(path_, kId, kOld).Execute("INSERT INTO notes VALUES ('kept')"); }
  EXPECT_FALSE(fs::exists(backup_));
  Database database = OpenFormatted(path_, kId, kNew);
  EXPECT_EQ(database.QueryInt("PRAGMA user_version"), 2);
  EXPECT_EQ(database.QueryInt("SELECT size FROM notes WHERE text = 'kept'"), 7);
  Database copy = OpenFormatted(backup_, kId, kOld);
  EXPECT_EQ(copy.QueryInt("SELECT count(*) FROM notes WHERE text = 'kept'"), 1);
}

TEST_F(DatabaseTest, AnUpgradeThatFailsChangesNothing) {
  { OpenFormatted(path_, kId, kOld).Execute("INSERT INTO notes VALUES ('kept')"); }
  EXPECT_NE(ErrorOf([&] { OpenFormatted(path_, kId, kBroken); }).find(path_), std::string::npos);
  Database database = OpenFormatted(path_, kId, kOld);
  EXPECT_EQ(database.QueryInt("SELECT count(*) FROM notes"), 1);
  EXPECT_EQ(OpenFormatted(path_, kId, kNew).QueryInt("SELECT sum(size) FROM notes"), 7);  // and can be tried again
}

TEST_F(DatabaseTest, RefusesANewerFormat) {
  { OpenFormatted(path_, kId, kNew); }
  const std::string error = ErrorOf([&] { OpenFormatted(path_, kId, kOld); });
  EXPECT_NE(error.find("newer version"), std::string::npos) << error;
  EXPECT_NE(error.find(path_), std::string::npos) << error;
  EXPECT_EQ(OpenFormatted(path_, kId, kNew).QueryInt("PRAGMA user_version"), 2);
}

TEST_F(DatabaseTest, RefusesFilesOfOthers) {
  { OpenFormatted(path_, kId, kOld); }
  EXPECT_NE(ErrorOf([&] { OpenFormatted(path_, kId + 1, kOld); }).find(path_), std::string::npos);
  std::ofstream(directory_ / "text.db") << std::string(5000, 'x');
  EXPECT_NE(ErrorOf([&] { OpenFormatted(directory_ / "text.db", kId, kOld); }).find("text.db"), std::string::npos);
  EXPECT_NE(ErrorOf([&] { OpenFormatted(directory_ / "no/such/folder.db", kId, kOld); }), "");
}

TEST(FileSystem, KnowsNetworkFilesystems) {
  for (std::uint64_t type : {0x6969u, 0xFF534D42u, 0x65735546u, 0x01021997u}) EXPECT_TRUE(IsNetworkFilesystem(type));
  // A type is a signed number in statfs(2).
  EXPECT_TRUE(IsNetworkFilesystem(static_cast<std::uint64_t>(static_cast<std::int32_t>(0xFF534D42u))));
  for (std::uint64_t type :
       {0xEF53u, 0x58465342u, 0x9123683Eu, 0x01021994u, 0x794C7630u}) {  // ext4 xfs btrfs tmpfs overlay
    EXPECT_FALSE(IsNetworkFilesystem(type));
  }
  EXPECT_NO_THROW(CheckLocal("/"));
}

}  // namespace
}  // namespace fascicle::server
