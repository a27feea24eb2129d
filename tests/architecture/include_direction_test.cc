// Dependencies between rooms have one direction: which room may include which, and which room may use which library.
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

// The room of a file is the first two levels of its folder: core/geometry, server/store, proto/rules.
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
  EXPECT_GT(includes.size(), 1000u) << "the sources were not found";
  return includes;
}

// What each room links: rooms by their folders, and libraries.
using Arrows = std::map<std::string, std::set<std::string>>;
const Arrows& LinkedBy() {
  static const Arrows arrows = {
#include "arrows.inc"
  };
  return arrows;
}

// The only interface by which other programs start a server in their own process.
constexpr const char* kDoor = "server/embedded_server.h";
constexpr const char* kBehindTheDoor = "fascicle_server_embedded";

// The room or library to link for a header; empty for headers from elsewhere.
std::string LinkedFor(const std::string& header) {
  if (header == kDoor) return kBehindTheDoor;
  if (std::regex_search(header, std::regex("^(fascicle/v1|google/rpc)/"))) return "proto";
  return std::regex_search(header, std::regex("^(core|server|client|proto)/")) ? RoomOf(header) : "";
}

TEST(IncludeDirection, RoomsIncludeWhatTheyLinkAndLinkWhatTheyInclude) {
  const std::vector<Include> includes = ReadIncludes();
  Arrows included;
  for (const Include& include : includes) {
    const std::string target = LinkedFor(include.target);
    if (target.empty() || RoomOf(include.target) == include.room) continue;
    included[include.room].insert(target);
    const auto linked = LinkedBy().find(include.room);
    ASSERT_NE(linked, LinkedBy().end()) << include.file << ": CMake knows no room " << include.room;
    EXPECT_TRUE(linked->second.contains(target)) << include.file << " includes " << include.target << ", but "
                                                 << include.room << " does not name " << target << " in its DEPS";
  }
  for (const auto& [room, linked] : LinkedBy()) {
    for (const std::string& target : linked) {
      const bool is_room = LinkedBy().contains(target) || target == "proto" || target == kBehindTheDoor;
      EXPECT_TRUE(!is_room || included[room].contains(target)) << room << " includes nothing of " << target;
    }
  }
}

// The room and everything that it links, directly or not.
std::set<std::string> Reached(const std::string& room) {
  std::set<std::string> reached;
  std::vector<std::string> open = {room};
  while (!open.empty()) {
    const auto linked = LinkedBy().find(open.back());
    open.pop_back();
    if (linked == LinkedBy().end()) continue;
    for (const std::string& target : linked->second) {
      if (reached.insert(target).second) open.push_back(target);
    }
  }
  return reached;
}

TEST(IncludeDirection, ArrowsPointOneWay) {
  struct Rule {
    std::regex rooms;
    std::regex never;
  };
  const std::vector<Rule> rules = {
      {std::regex("^core/"), std::regex("^(proto|server|client)|fascicle_server|GRPC|protobuf|SQLite")},
      {std::regex("^core/materials$"), std::regex("^core/geometry$")},
      {std::regex("^core/tet$"), std::regex("^core/(voxel|eulerian)$")},
      {std::regex("^core/voxel$"), std::regex("^core/(tet|eulerian)$")},
      {std::regex("^core/eulerian$"), std::regex("^core/(tet|voxel)$")},
      {std::regex("^proto"), std::regex("^(server|client)")},
      {std::regex("^server"), std::regex("^client")},
      {std::regex("^server/store$"), std::regex("^proto|^core/(?!base)")},
      {std::regex("^server/jobs$"), std::regex("^proto|^server/(rpc|translate)|GRPC")},
      {std::regex("^client/(?!cli)"), std::regex("^server|fascicle_server|^core/(scene|sim|tet|voxel|eulerian)")},
      {std::regex("^client/cli$"), std::regex("^server")},
  };
  for (const auto& [room, linked] : LinkedBy()) {
    const std::set<std::string> reached = Reached(room);
    EXPECT_FALSE(reached.contains(room)) << room << " comes with itself";
    for (const Rule& rule : rules) {
      if (!std::regex_search(room, rule.rooms)) continue;
      for (const std::string& target : reached) {
        EXPECT_FALSE(std::regex_search(target, rule.never)) << room << " comes with " << target;
      }
    }
  }
}

// Libraries that only some rooms may include.
TEST(IncludeDirection, LibrariesStayInTheirRooms) {
  struct Rule {
    const char* library;
    std::regex header;
    std::regex rooms;
  };
  const std::vector<Rule> rules = {
      {"gRPC", std::regex("^(grpc|grpcpp)/"), std::regex("^(server/rpc|server|client/lib|client/cli)$")},
      {"Protobuf", std::regex("^google/protobuf/|\\.pb\\.h$"),
       std::regex("^(proto/(rules|frames)|server/translate|server/rpc|server|client/.*)$")},
      {"SQLite", std::regex("^sqlite3\\.h$"), std::regex("^server/store$")},
      {"zstd", std::regex("^zstd"), std::regex("^proto/frames$")},
      {"ITK", std::regex("^(itk[A-Z]|vnl/)"), std::regex("^core/imaging$")},
      {"VTK", std::regex("^vtk[A-Z]"), std::regex("^client/(exodus|export|image|render|vtk)$")},
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
