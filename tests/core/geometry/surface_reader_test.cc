#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "core/base/stop.h"
#include "core/geometry/ear_clipping.h"
#include "surface_samples.h"
#include "tests/support/files.h"
#include "tests/support/paths.h"

namespace fascicle {
namespace {

using ::testing::HasSubstr;

std::optional<TriangleMesh> ReadText(const std::string& name, const std::string& bytes) {
  Problems problems;
  std::optional<TriangleMesh> surface = ReadSurface(name, bytes, problems);
  EXPECT_TRUE(problems.empty()) << name << ": " << problems.ToString();
  return surface;
}

std::string ProblemsOf(const std::string& name, const std::string& bytes) {
  Problems problems;
  EXPECT_FALSE(ReadSurface(name, bytes, problems)) << name;
  for (const Problem& problem : problems.kept()) EXPECT_TRUE(problem.path.empty());
  return problems.ToString();
}

// Any bytes give a surface with indices in range, or problems.
void ExpectSound(const std::string& name, const std::string& bytes) {
  // A separate allocation, so that the address sanitizer detects reads beyond the end.
  const std::vector<char> copy(bytes.begin(), bytes.end());
  Problems problems;
  const auto surface = ReadSurface(name, {copy.data(), copy.size()}, problems);
  ASSERT_EQ(surface.has_value(), problems.empty());
  if (!surface) return;
  for (const Triangle& triangle : surface->triangles) {
    for (const std::int32_t n : triangle) ASSERT_TRUE(n >= 0 && std::size_t(n) < surface->nodes.size());
  }
  for (const Vec3& node : surface->nodes) ASSERT_TRUE(node.allFinite());
}

class EverySurface : public ::testing::TestWithParam<SurfaceSample> {};

TEST_P(EverySurface, IsRead) {
  const auto surface = ReadText(GetParam().name, GetParam().bytes);
  ASSERT_TRUE(surface);
  EXPECT_EQ(surface->nodes, CornerSurface().nodes);
  EXPECT_EQ(surface->triangles, CornerSurface().triangles);
  EXPECT_DOUBLE_EQ(EnclosedVolume(*surface), 1.0 / 6);
  EXPECT_DOUBLE_EQ(Area(*surface), 1.5 + std::sqrt(3) / 2);
}

TEST_P(EverySurface, HeedsStopRequests) {
  std::stop_source source;
  source.request_stop();
  Problems problems;
  EXPECT_THROW(ReadSurface(GetParam().name, GetParam().bytes, problems, source.get_token()), Stopped);
  EXPECT_TRUE(problems.empty()) << problems.ToString();
}

TEST_P(EverySurface, CutAnywhere) {
  for (std::size_t size = 0; size < GetParam().bytes.size(); ++size) {
    ExpectSound(GetParam().name, GetParam().bytes.substr(0, size));
  }
}

TEST_P(EverySurface, DamagedAnywhere) {
  std::mt19937 random(4);
  for (int round = 0; round < 600; ++round) {
    std::string damaged = GetParam().bytes;
    for (int changes = 1 + static_cast<int>(random() % 4); changes > 0; --changes) {
      const char bytes[] = {'9', '-', ' ', '\n', '\0', '\xff', '/', 'e', static_cast<char>(random())};
      damaged[random() % damaged.size()] = bytes[random() % std::size(bytes)];
    }
    ExpectSound(GetParam().name, damaged);
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, EverySurface, ::testing::ValuesIn(SurfaceSamples()), [](const auto& test) {
  std::string name = test.param.name;
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
});

TEST(SurfaceReaderTest, PolygonsBecomeTriangles) {
  const auto surface = ReadText("square.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
  ASSERT_TRUE(surface);
  EXPECT_EQ(surface->triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
}

// Corners that turn inwards and corners on straight lines: a prism over an L whose longest side is divided.
TEST(SurfaceReaderTest, PolygonsOfAnyShape) {
  const std::string prism =
      "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\n"
      "v 0 0 1\nv 1 0 1\nv 2 0 1\nv 2 1 1\nv 1 1 1\nv 1 2 1\nv 0 2 1\n";
  for (int start = 0; start < 7; ++start) {
    std::string lower = "f", upper = "f", sides;
    for (int i = 0; i < 7; ++i) {
      const int at = (start + i) % 7, next = (at + 1) % 7;
      lower.insert(1, " " + std::to_string(1 + at));
      upper += " " + std::to_string(8 + at);
      sides += "f " + std::to_string(1 + at) + " " + std::to_string(1 + next) + " " + std::to_string(8 + next) + " " +
               std::to_string(8 + at) + "\n";
    }
    const auto surface = ReadText("prism.obj", prism + lower + "\n" + upper + "\n" + sides);
    ASSERT_TRUE(surface);
    EXPECT_EQ(surface->triangles.size(), 2u * 5 + 7 * 2);
    EXPECT_DOUBLE_EQ(EnclosedVolume(*surface), 3);
    EXPECT_DOUBLE_EQ(Area(*surface), 2 * 3 + 8) << "overlapping triangles have a larger area";
    for (const auto& [a, b, c] : surface->triangles) {
      const Vec3 ab = surface->nodes[b] - surface->nodes[a], ac = surface->nodes[c] - surface->nodes[a];
      EXPECT_GT(ab.cross(ac).norm(), 0.1);
    }
  }
}

std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
  return text;
}

std::string Upper(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

void ExpectCorner(const std::string& name, const std::string& bytes, const std::string& note) {
  Problems problems;
  std::vector<std::string> notes;
  const auto surface = ReadSurface(name, bytes, problems, {}, &notes);
  ASSERT_TRUE(surface) << name << ": " << problems.ToString();
  EXPECT_EQ(surface->triangles, CornerSurface().triangles) << name;
  ASSERT_EQ(notes.size(), note.empty() ? 0u : 1u) << name;
  if (!note.empty()) {
    EXPECT_THAT(notes[0], HasSubstr(note));
  }
}

TEST(SurfaceReaderTest, ByteOrderMarksAndUpperCase) {
  const std::string mark = "\xEF\xBB\xBF";
  for (const SurfaceSample& sample : SurfaceSamples()) {
    ExpectCorner(Upper(sample.name), sample.bytes, "");
    if (sample.bytes.find('\0') == std::string::npos) ExpectCorner(sample.name, mark + sample.bytes, "");
  }
  ExpectCorner("a.obj", mark + Replaced(kObj, "# a comment\nmtllib none.mtl\n", ""), "");
  ExpectCorner("a.stl", Upper(kAsciiStl), "");
  ExpectCorner("a.stl", Replaced(Replaced(kAsciiStl, "facet", "Facet"), "vertex", "Vertex"), "");
}

TEST(SurfaceReaderTest, LineEndsOfAnySystem) {
  for (const std::string end : {"\r\n", "\r"}) {
    ExpectCorner("a.obj", Replaced(kObj, "\n", end), "");
    ExpectCorner("a.stl", Replaced(kAsciiStl, "\n", end), "");
    ExpectCorner("a.ply", Replaced(kAsciiPly, "\n", end), "");
    ExpectCorner("a.obj", Replaced(Replaced(kObj, "f 1 2 3", "f 1 \\\n 2 \\\n3"), "\n", end), "");
  }
  EXPECT_THAT(ProblemsOf("a.obj", "v 0 0 0\rv 1 zero 0\r"), HasSubstr("line 2: expected a coordinate"));
  EXPECT_THAT(ProblemsOf("a.obj", "v 0 0 0\nv 1 0 \\\n0\nv 1 zero 0\n"), HasSubstr("line 4: expected a coordinate"));
}

TEST(SurfaceReaderTest, FlawsOfStlAreReadWithANote) {
  const std::string binary = BinaryStl(CornerSurface());
  ExpectCorner("a.stl", binary + "\r\n", "the last 2 bytes of the file, after its 4 triangles, are left out");
  ExpectCorner("a.stl", binary + std::string(1000, '\0'), "the last 1000 bytes");
  std::string uncounted = binary;
  uncounted.replace(80, 4, std::string(4, '\0'));
  ExpectCorner("a.stl", uncounted, "announces no triangles but has 4");
  ExpectCorner("a.stl", Replaced(kAsciiStl, "endsolid corner\n", ""), "ends without `endsolid`, after 4 triangles");
}

TEST(SurfaceReaderTest, SaysWhatIsWrongAndWhere) {
  EXPECT_THAT(ProblemsOf("a.step", ""), HasSubstr(".stl, .obj, .ply, .vtp"));
  EXPECT_THAT(ProblemsOf("a.obj", "v 0 0 0\nv 1 zero 0\n"),
              HasSubstr("line 2: expected a coordinate but found `zero`"));
  EXPECT_THAT(ProblemsOf("a.obj", "v 0 0 0\nf 1 2 3\n"), HasSubstr("refer to nodes that do not exist"));
  EXPECT_THAT(ProblemsOf("a.obj", "v 0 0 0\nv 1 0 0\nv nan 0 0\nf 1 2 3\n"), HasSubstr("not finite"));
  EXPECT_THAT(ProblemsOf("a.obj", "v 0 0 0\n"), HasSubstr("no triangles"));
  EXPECT_THAT(ProblemsOf("a.stl", std::string(kAsciiStl).substr(0, std::string(kAsciiStl).find(" endloop"))),
              HasSubstr("is the file complete?"));
  EXPECT_THAT(ProblemsOf("a.stl", BinaryStl(CornerSurface()).substr(0, 250)), HasSubstr("announces 4 triangles"));
  EXPECT_THAT(ProblemsOf("a.stl", Replaced(kAsciiStl, "1 0 0", "1,0 0 0")), HasSubstr("a decimal point, not a comma"));
  EXPECT_THAT(ProblemsOf("a.vtu", ""), HasSubstr("--convert"));
  std::string many = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf";
  for (std::size_t i = 0; i <= kMostCorners; ++i) many += " " + std::to_string(1 + i % 3);
  EXPECT_THAT(ProblemsOf("a.obj", many + "\n"), HasSubstr("a polygon of 20001 corners"));
  EXPECT_THAT(ProblemsOf("a.ply", "ply\nformat ascii 1.0\nelement vertex 99999999\n"), HasSubstr("announced"));
  EXPECT_THAT(ProblemsOf("a.vtp", "<VTKFile type=\"UnstructuredGrid\"/>"), HasSubstr("poly data"));
}

// Bones as in OpenSim.
TEST(SurfaceReaderTest, RealVtp) {
  const auto path = testing::DataFolder() / "opensim_arm26/Geometry/arm_r_humerus.vtp";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there; set FASCICLE_DATA";
  const auto surface = ReadText(path, testing::ReadFile(path));
  ASSERT_TRUE(surface);
  EXPECT_NEAR(Diagonal(surface->nodes), 0.36, 0.04);  // an upper arm [m]
}

}  // namespace
}  // namespace fascicle
