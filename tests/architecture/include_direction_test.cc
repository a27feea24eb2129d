// The arrows between rooms point one way: who may include whom, and which room may touch which library.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "tests/support/paths.h"

namespace {

namespace fs = std::filesystem;

struct Include {
  std::string file;  // relative to the root
  std::string room;  // of the file
  std::string target;
};

// A room is the folder of a file, and belongs to the first two levels: core/geometry, server/store, proto/rules.
std::string RoomOf(const std::string& path) {
  const std::size_t first = path.find('/');
  if (first == std::string::npos) return "";
  const std::size_t second = path.find('/', first + 1);
  return second == std::string::npos ? path.substr(0, first) : path.substr(0, second);
}

std::vector<Include> ReadIncludes() {
  const fs::path root = fascicle::testing::ProjectRoot();
  const std::regex pattern(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"])");
  std::vector<Include> includes;
  for (const char* top : {"core", "server", "client", "proto"}) {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root / top)) {
      const std::string extension = entry.path().extension().string();
      if (extension != ".h" && extension != ".cc") continue;
      const std::string file = fs::relative(entry.path(), root).generic_string();
      std::ifstream in(entry.path());
      std::smatch match;
      for (std::string line; std::getline(in, line);) {
        if (std::regex_search(line, match, pattern)) includes.push_back({file, RoomOf(file), match[1]});
      }
    }
  }
  return includes;
}

// What each room may include beside itself. A room that is not listed here is an error.
const std::map<std::string, std::set<std::string>>& AllowedRooms() {
  static const std::map<std::string, std::set<std::string>> allowed = {
      {"core/base", {}},
      {"core/geometry", {"core/base"}},
      {"core/imaging", {"core/base", "core/geometry"}},
      {"core/linalg", {"core/base"}},
      {"core/materials", {"core/base"}},
      {"core/muscle", {"core/base", "core/geometry", "core/linalg", "core/materials"}},
      {"core/scene", {"core/base", "core/geometry", "core/materials", "core/muscle"}},
      {"core/tet", {"core/base", "core/geometry", "core/linalg", "core/materials", "core/muscle", "core/scene"}},
      {"core/eulerian", {"core/base", "core/geometry", "core/linalg", "core/materials", "core/muscle", "core/scene"}},
      {"core/voxel", {"core/base", "core/geometry", "core/linalg", "core/materials", "core/muscle", "core/scene"}},
      {"core/sim",
       {"core/base", "core/eulerian", "core/geometry", "core/materials", "core/muscle", "core/scene", "core/tet",
        "core/voxel"}},
      {"proto/rules", {"core/base", "fascicle/v1"}},
      {"server/store", {"core/base"}},
      {"server/jobs", {"core/base", "core/scene", "core/sim", "server/store"}},
      {"server/translate",
       {"core/base", "core/eulerian", "core/geometry", "core/imaging", "core/materials", "core/muscle", "core/scene",
        "core/sim", "core/voxel", "fascicle/v1", "proto/rules", "server/jobs", "server/store"}},
      {"server/rpc",
       {"core/base", "fascicle/v1", "google/rpc", "server/jobs", "server/store", "server/translate", "proto/rules"}},
      {"server", {"core/base", "server/jobs", "server/store", "server/translate", "server/rpc"}},
      {"client/lib", {"core/base", "fascicle/v1", "google/rpc", "proto/rules"}},
      {"client/image", {"core/base", "core/geometry"}},
      {"client/export", {"core/base", "client/lib", "fascicle/v1"}},
      {"client/import", {"core/base", "core/geometry", "fascicle/v1", "proto/rules"}},
      {"client/render", {"core/base", "client/lib", "fascicle/v1"}},
      {"client/cli",
       {"core/base", "core/geometry", "core/imaging", "core/materials", "client/lib", "client/import", "client/export",
        "client/image", "client/render", "fascicle/v1", "proto/rules"}},
  };
  return allowed;
}

bool IsOurs(const std::string& target) {
  return std::regex_search(target, std::regex("^(core|server|client|proto|fascicle/v1|google/rpc)/"));
}

TEST(IncludeDirection, RoomsIncludeOnlyTheRoomsBelowThem) {
  const std::vector<Include> includes = ReadIncludes();
  ASSERT_GT(includes.size(), 200u) << "the sources were not found";
  for (const Include& include : includes) {
    if (!IsOurs(include.target)) continue;
    const std::string target_room = RoomOf(include.target);
    if (target_room == include.room) continue;
    // The command line alone may start a server in its own process, through this one door.
    if (include.room == "client/cli" && include.target == "server/embedded_server.h") continue;
    const auto allowed = AllowedRooms().find(include.room);
    ASSERT_NE(allowed, AllowedRooms().end()) << include.file << ": room " << include.room << " is not in the table";
    EXPECT_TRUE(allowed->second.contains(target_room)) << include.file << " includes " << include.target;
  }
}

// Libraries that only some rooms may see.
TEST(IncludeDirection, LibrariesStayInTheirRooms) {
  struct Rule {
    const char* library;
    std::regex header;
    std::regex rooms;
  };
  const std::vector<Rule> rules = {
      {"gRPC", std::regex("^(grpc|grpcpp)/"), std::regex("^(server/rpc|server|client/lib|client/cli)$")},
      {"Protobuf", std::regex("^google/protobuf/|\\.pb\\.h$"),
       std::regex("^(proto/rules|server/translate|server/rpc|server|client/.*)$")},
      {"SQLite", std::regex("^sqlite3\\.h$"), std::regex("^server/store$")},
      {"ITK", std::regex("^(itk[A-Z]|vnl/)"), std::regex("^core/imaging$")},
      {"VTK", std::regex("^vtk[A-Z]"), std::regex("^client/(export|image|render)$")},
      {"CLI11", std::regex("^CLI/"), std::regex("^(client/cli|server)$")},
      {"JSON", std::regex("^nlohmann/"), std::regex("^client/(lib|cli|export)$")},
  };
  for (const Include& include : ReadIncludes()) {
    for (const Rule& rule : rules) {
      if (!std::regex_search(include.target, rule.header)) continue;
      EXPECT_TRUE(std::regex_search(include.room, rule.rooms))
          << include.file << " includes " << include.target << ": " << rule.library << " has no business in "
          << include.room;
    }
  }
}

TEST(IncludeDirection, NothingIncludesUpwardsByRelativePath) {
  for (const Include& include : ReadIncludes()) {
    EXPECT_EQ(include.target.find("../"), std::string::npos) << include.file << " includes " << include.target;
  }
}

}  // namespace
