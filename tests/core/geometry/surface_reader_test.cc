#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "core/base/stop.h"
#include "surface_samples.h"
#include "tests/support/files.h"
#include "tests/support/paths.h"

namespace fascicle {
namespace {

using ::testing::HasSubstr;

std::optional<TriangleMesh> Read(const std::string& name, const std::string& bytes) {
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
  const auto surface = Read(GetParam().name, GetParam().bytes);
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
  const auto surface = Read("square.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
  ASSERT_TRUE(surface);
  EXPECT_EQ(surface->triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
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
  EXPECT_THAT(ProblemsOf("a.stl", BinaryStl(CornerSurface()) + "x"), HasSubstr("line 1"));
  EXPECT_THAT(ProblemsOf("a.ply", "ply\nformat ascii 1.0\nelement vertex 99999999\n"), HasSubstr("announced"));
  EXPECT_THAT(ProblemsOf("a.vtp", "<VTKFile type=\"UnstructuredGrid\"/>"), HasSubstr("poly data"));
}

// Bones as in OpenSim.
TEST(SurfaceReaderTest, RealVtp) {
  const auto path = testing::DataFolder() / "opensim_arm26/Geometry/arm_r_humerus.vtp";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there; set FASCICLE_DATA";
  const auto surface = Read(path, testing::ReadFile(path));
  ASSERT_TRUE(surface);
  EXPECT_NEAR(Diagonal(surface->nodes), 0.36, 0.04);  // an upper arm [m]
}

}  // namespace
}  // namespace fascicle
