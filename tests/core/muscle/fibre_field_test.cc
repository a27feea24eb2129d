#include "core/muscle/fibre_field.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/LU>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "core/base/stop.h"
#include "core/geometry/mesh_io.h"
#include "core/geometry/region.h"
#include "core/geometry/shapes.h"
#include "tests/support/files.h"
#include "tests/support/nodes_where.h"
#include "tests/support/paths.h"

namespace fascicle {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

// --- Constant --------------------------------------------------------------------------------------------------------

TEST(ConstantFibres, AreUnitWhateverTheLength) {
  const TetMesh box = MakeBox(Vec3::Zero(), Vec3::Ones(), {1, 1, 1});
  for (const double length : {1e-200, 3.0, 1e200}) {
    const FibreField fibres = ConstantFibres(box, length * Vec3(1, 2, 2));
    ASSERT_THAT(fibres, SizeIs(box.tetrahedra.size()));
    for (const Vec3& a : fibres) EXPECT_LE((a - Vec3(1, 2, 2) / 3).norm(), 1e-15);
  }
}

// --- File ------------------------------------------------------------------------------------------------------------

class ReadFibresTest : public ::testing::Test {
 protected:
  // Six tetrahedra.
  const TetMesh box_ = MakeBox(Vec3::Zero(), Vec3::Ones(), {1, 1, 1});
  Problems problems_;
};

TEST_F(ReadFibresTest, NormalizesAndSkipsCommentsAndBlankLines) {
  const FibreField fibres =
      ReadFibres(box_, "# six\n0 0 2\r\n\n 3 0 0 # x\n\t0 -5e-1\t0\n+1 0 0\n0 3 4\n1e300 0 1e300", problems_);
  EXPECT_THAT(problems_.ToString(), IsEmpty());
  ASSERT_THAT(fibres, SizeIs(6));
  EXPECT_EQ(fibres[0], Vec3::UnitZ());
  EXPECT_EQ(fibres[1], Vec3::UnitX());
  EXPECT_EQ(fibres[2], -Vec3::UnitY());
  EXPECT_EQ(fibres[3], Vec3::UnitX());
  EXPECT_LE((fibres[4] - Vec3(0, 0.6, 0.8)).norm(), 1e-15);
  EXPECT_LE((fibres[5] - Vec3(1, 0, 1) / std::numbers::sqrt2).norm(), 1e-15);
}

TEST_F(ReadFibresTest, NamesEveryBadLine) {
  const FibreField fibres = ReadFibres(box_, "0 0 1\n0 0\n0 0 0\n1 2 3 4\nnan 0 1\n0 inf 1", problems_);
  EXPECT_THAT(fibres, IsEmpty());
  ASSERT_THAT(problems_.kept(), SizeIs(5));
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_THAT(problems_.kept()[i].message, HasSubstr("line " + std::to_string(i + 2) + ":"));
    EXPECT_THAT(problems_.kept()[i].path, IsEmpty());
  }
}

TEST_F(ReadFibresTest, RefusesMalformedText) {
  const std::string good = "0 0 1\n0 0 1\n0 0 1\n0 0 1\n0 0 1\n";
  for (const std::string& last :
       {std::string(), std::string("0 0 1\n0 0 1\n"), std::string("0,0,1"), std::string("0 0 1x"),
        std::string("0 0 +-1"), std::string("0 0 1e999"), std::string("zero"), std::string("0 0 0x1"),
        std::string("\0\0\0", 3), std::string("0 0 -0"), std::string("\xff\xfe")}) {
    Problems problems;
    EXPECT_THAT(ReadFibres(box_, good + last, problems), IsEmpty()) << last;
    EXPECT_FALSE(problems.empty()) << last;
  }
  Problems problems;
  EXPECT_THAT(ReadFibres(box_, "", problems), IsEmpty());
  EXPECT_THAT(problems.ToString(), HasSubstr("0 fibre directions for 6 tetrahedra"));
}

TEST_F(ReadFibresTest, ManyBadLinesAreCountedNotKept) {
  std::string text;
  for (int i = 0; i < 100'000; ++i) text += "x\n";
  EXPECT_THAT(ReadFibres(box_, text, problems_), IsEmpty());
  EXPECT_EQ(problems_.count(), 100'001u);
  EXPECT_THAT(problems_.kept(), SizeIs(Problems::kMaxKept));
}

// --- Harmonic --------------------------------------------------------------------------------------------------------

// phi = z / length is the exact solution and in the finite element space.
TEST(HarmonicFibres, AreStraightInABox) {
  const TetMesh box = MakeBox(Vec3(-1, 2, 3), Vec3(0.03, 0.02, 0.2), {4, 3, 20});
  const auto origin = NodesWhere(box, [](const Vec3& X) { return X.z() < 3 + 1e-9; });
  const auto insertion = NodesWhere(box, [](const Vec3& X) { return X.z() > 3.2 - 1e-9; });
  Problems problems;
  const FibreField fibres = HarmonicFibres(box, origin, insertion, problems);
  EXPECT_TRUE(problems.empty());
  ASSERT_THAT(fibres, SizeIs(box.tetrahedra.size()));
  for (const Vec3& a : fibres) EXPECT_LE((a - Vec3::UnitZ()).norm(), 1e-8);
  // Fibres run from the origin to the insertion, and reverse if these are swapped.
  const FibreField reversed = HarmonicFibres(box, insertion, origin, problems);
  for (const Vec3& a : reversed) EXPECT_LE((a + Vec3::UnitZ()).norm(), 1e-8);
}

// Between concentric spherical caps the potential is 1/r, so its gradient is radial. A wedge of a box is bent into a
// shell.
TEST(HarmonicFibres, AreRadialBetweenConcentricSpheres) {
  constexpr int kAcross = 12;
  TetMesh shell = MakeBox(Vec3(-0.3, -0.3, 1), Vec3(0.6, 0.6, 1), {kAcross, kAcross, 24});
  for (Vec3& X : shell.nodes) X = X.z() * Vec3(X.x(), X.y(), 1).normalized();
  const auto origin = NodesWhere(shell, [](const Vec3& X) { return X.norm() < 1 + 1e-9; });
  const auto insertion = NodesWhere(shell, [](const Vec3& X) { return X.norm() > 2 - 1e-9; });
  Problems problems;
  const FibreField fibres = HarmonicFibres(shell, origin, insertion, problems);
  ASSERT_THAT(fibres, SizeIs(shell.tetrahedra.size()));
  double sum = 0;
  for (std::size_t e = 0; e < fibres.size(); ++e) sum += (fibres[e] - Centroid(shell, e).normalized()).norm();
  // The gradient of linear elements is of first order in h = 0.05.
  EXPECT_LE(sum / static_cast<double>(fibres.size()), 0.025);
}

TEST(HarmonicFibres, FollowASpindleSymmetrically) {
  const Fusiform shape{
      .length = 0.2, .belly_radius = 0.02, .end_radius = 0.008, .divisions_across = 8, .divisions_along = 30};
  const TetMesh spindle = MakeFusiform(shape);
  const auto origin = NodesWhere(spindle, [](const Vec3& X) { return X.z() < 1e-9; });
  const auto insertion = NodesWhere(spindle, [](const Vec3& X) { return X.z() > 0.2 - 1e-9; });
  Problems problems;
  const FibreField fibres = HarmonicFibres(spindle, origin, insertion, problems);
  ASSERT_THAT(fibres, SizeIs(spindle.tetrahedra.size()));

  Vec3 mean = Vec3::Zero();
  double volume = 0, outward_lower = 0, outward_upper = 0;
  for (std::size_t e = 0; e < fibres.size(); ++e) {
    const double v = SignedVolume(spindle, e);
    const Vec3 X = Centroid(spindle, e);
    const Vec3 radial = Vec3(X.x(), X.y(), 0).normalized();
    EXPECT_GT(fibres[e].z(), 0.7);
    mean += v * fibres[e];
    volume += v;
    (X.z() < 0.1 ? outward_lower : outward_upper) += v * fibres[e].dot(radial);
  }
  mean /= volume;
  // No side is preferred, except by the mesh's own diagonals; fibres diverge towards the belly and converge behind it
  // alike.
  EXPECT_LE(std::hypot(mean.x(), mean.y()), 2e-3);
  EXPECT_GT(outward_lower / volume, 0.01);
  EXPECT_NEAR(outward_lower / volume, -outward_upper / volume, 1e-3);
}

// The same potential from a dense matrix, shape functions from a 4x4 inverse and a direct solver: an independent
// implementation.
TEST(HarmonicFibres, AgreeWithADenseSolve) {
  const TetMesh ball = MakeSphere(1, 6);
  const auto origin = NodesWhere(ball, [](const Vec3& X) { return X.z() < -0.75; });
  const auto insertion = NodesWhere(ball, [](const Vec3& X) { return X.x() > 0.75; });
  Problems problems;
  const FibreField fibres = HarmonicFibres(ball, origin, insertion, problems);
  ASSERT_THAT(fibres, SizeIs(ball.tetrahedra.size()));

  const auto n = static_cast<Eigen::Index>(ball.nodes.size());
  Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(n, n);
  std::vector<Eigen::Matrix<double, 4, 3>> gradients;
  for (std::size_t e = 0; e < ball.tetrahedra.size(); ++e) {
    // Shape functions from their nodal values: [1 X][c] = I.
    Eigen::Matrix4d values;
    for (int a = 0; a < 4; ++a) {
      values.row(a) << 1,
          ball.nodes[static_cast<std::size_t>(ball.tetrahedra[e][static_cast<std::size_t>(a)])].transpose();
    }
    const Eigen::Matrix4d coefficients = values.inverse();
    const Eigen::Matrix<double, 4, 3> gradient = coefficients.bottomRows<3>().transpose();
    gradients.push_back(gradient);
    const Eigen::Matrix4d element = values.determinant() / 6 * gradient * gradient.transpose();
    for (std::size_t a = 0; a < 4; ++a) {
      for (std::size_t b = 0; b < 4; ++b) {
        stiffness(ball.tetrahedra[e][a], ball.tetrahedra[e][b]) +=
            element(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b));
      }
    }
  }
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
  for (const auto& [nodes, value] : {std::pair(origin, 0.0), std::pair(insertion, 1.0)}) {
    for (const std::int32_t node : nodes) {
      stiffness.row(node).setZero();
      stiffness(node, node) = 1;
      right[node] = value;
    }
  }
  const Eigen::VectorXd potential = stiffness.partialPivLu().solve(right);
  int compared = 0;
  for (std::size_t e = 0; e < fibres.size(); ++e) {
    Eigen::Vector4d phi;
    for (int a = 0; a < 4; ++a) phi[a] = potential[ball.tetrahedra[e][static_cast<std::size_t>(a)]];
    const Vec3 gradient = gradients[e].transpose() * phi;
    if (gradient.norm() < 1e-3) continue;  // filled from the neighbours
    EXPECT_LE((fibres[e] - gradient.normalized()).norm(), 1e-8);
    ++compared;
  }
  EXPECT_GT(compared, static_cast<int>(fibres.size()) / 2);
}

TEST(HarmonicFibres, FillFlatPartsFromTheirNeighbours) {
  const TetMesh box = MakeBox(Vec3::Zero(), Vec3(1, 1, 10), {2, 2, 20});
  // Both regions are blocks several elements thick, with zero gradient inside.
  const auto origin = NodesWhere(box, [](const Vec3& X) { return X.z() < 2.1; });
  const auto insertion = NodesWhere(box, [](const Vec3& X) { return X.z() > 7.9; });
  Problems problems;
  const FibreField fibres = HarmonicFibres(box, origin, insertion, problems);
  EXPECT_TRUE(problems.empty());
  ASSERT_THAT(fibres, SizeIs(box.tetrahedra.size()));
  for (const Vec3& a : fibres) EXPECT_LE((a - Vec3::UnitZ()).norm(), 1e-8);
}

TEST(HarmonicFibres, HeedStopRequests) {
  const TetMesh box = MakeBox(Vec3::Zero(), Vec3::Ones(), {2, 2, 2});
  const auto bottom = NodesWhere(box, [](const Vec3& X) { return X.z() < 0.1; });
  const auto top = NodesWhere(box, [](const Vec3& X) { return X.z() > 0.9; });
  std::stop_source source;
  source.request_stop();
  Problems problems;
  EXPECT_THROW(HarmonicFibres(box, bottom, top, problems, source.get_token()), Stopped);
  EXPECT_TRUE(problems.empty());
}

TEST(HarmonicFibres, ReportWhatIsWrongWithTheRegions) {
  const TetMesh box = MakeBox(Vec3::Zero(), Vec3::Ones(), {2, 2, 2});
  const auto bottom = NodesWhere(box, [](const Vec3& X) { return X.z() < 0.1; });
  const auto lower = NodesWhere(box, [](const Vec3& X) { return X.z() < 0.6; });
  const auto top = NodesWhere(box, [](const Vec3& X) { return X.z() > 0.9; });
  const std::vector<std::int32_t> none, outside = {0, 4711, -1};
  const auto message = [&](const auto& origin, const auto& insertion) {
    Problems problems;
    EXPECT_THAT(HarmonicFibres(box, origin, insertion, problems), IsEmpty());
    return problems.ToString();
  };
  EXPECT_THAT(message(none, top), HasSubstr("origin contains no node"));
  EXPECT_THAT(message(bottom, none), HasSubstr("insertion contains no node"));
  EXPECT_THAT(message(bottom, lower), HasSubstr("9 nodes belong to"));
  EXPECT_THAT(message(top, outside), HasSubstr("2 nodes of origin and insertion are not in the mesh"));
}

TEST(HarmonicFibres, ReportPartsThatNoPathReaches) {
  TetMesh two = MakeBox(Vec3::Zero(), Vec3::Ones(), {1, 1, 2});
  const TetMesh other = MakeBox(Vec3(5, 0, 0), Vec3::Ones(), {1, 1, 1});
  const auto shift = static_cast<std::int32_t>(two.nodes.size());
  const auto origin = NodesWhere(two, [](const Vec3& X) { return X.z() < 0.1; });
  const auto insertion = NodesWhere(two, [](const Vec3& X) { return X.z() > 0.9; });
  two.nodes.insert(two.nodes.end(), other.nodes.begin(), other.nodes.end());
  for (Tetrahedron tetrahedron : other.tetrahedra) {
    for (std::int32_t& node : tetrahedron) node += shift;
    two.tetrahedra.push_back(tetrahedron);
  }
  Problems problems;
  EXPECT_THAT(HarmonicFibres(two, origin, insertion, problems), IsEmpty());
  EXPECT_THAT(problems.ToString(), HasSubstr("6 tetrahedra have no path"));
}

TEST(HarmonicFibres, ReportFlatTetrahedra) {
  TetMesh box = MakeBox(Vec3::Zero(), Vec3::Ones(), {2, 2, 2});
  const auto bottom = NodesWhere(box, [](const Vec3& X) { return X.z() < 0.1; });
  const auto top = NodesWhere(box, [](const Vec3& X) { return X.z() > 0.9; });
  for (Vec3& X : box.nodes) X.x() = 0;
  Problems problems;
  EXPECT_THAT(HarmonicFibres(box, bottom, top, problems), IsEmpty());
  EXPECT_THAT(problems.ToString(), HasSubstr("did not converge"));
}

// --- Real anatomy ----------------------------------------------------------------------------------------------------

// The biceps femoris of the Visible Human, against the fibres published with it for the same two attachments (means
// over the ten nodes of quadratic tetrahedra). Measured: 3.40 degrees on average.
TEST(HarmonicFibres, AgreeWithThoseOfARealMuscle) {
  const std::filesystem::path data = testing::DataFolder();
  const std::filesystem::path base = data / "vh_muscle_tets/VHM_Left_Muscle_BicepsFemorisLongus";
  if (!std::filesystem::exists(base.string() + ".msh"))
    GTEST_SKIP() << "no anatomy in " << data << "; set FASCICLE_DATA";
  const std::string bytes = testing::ReadFile(base.string() + ".msh");
  Problems problems;
  const auto mesh = ReadMesh({.name = "muscle.msh", .bytes = bytes, .element_bytes = {}}, problems);
  ASSERT_TRUE(mesh) << problems.ToString();
  const auto surface = BoundaryTriangles(*mesh);
  const Region first = SelectRegion(*mesh, surface, "attach1", TagSelector{1});
  const Region second = SelectRegion(*mesh, surface, "attach2", TagSelector{2});
  const FibreField harmonic = HarmonicFibres(*mesh, first.nodes, second.nodes, problems);
  const FibreField published = ReadFibres(*mesh, testing::ReadFile(base.string() + ".fibres.txt"), problems);
  ASSERT_TRUE(problems.empty()) << problems.ToString();
  ASSERT_EQ(harmonic.size(), published.size());

  double sum = 0, volume = 0;
  for (std::size_t e = 0; e < harmonic.size(); ++e) {
    // Fibres have no sign.
    const double cosine = std::min(1.0, std::abs(harmonic[e].dot(published[e])));
    const double v = SignedVolume(*mesh, e);
    sum += v * std::acos(cosine);
    volume += v;
  }
  const double mean_degrees = sum / volume * 180 / std::numbers::pi;
  RecordProperty("mean_angle_degrees", ::testing::PrintToString(mean_degrees));
  EXPECT_LE(mean_degrees, 5);
}

}  // namespace
}  // namespace fascicle
