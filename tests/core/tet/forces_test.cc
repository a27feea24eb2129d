#include "core/tet/forces.h"

#include <gtest/gtest.h>

#include <cstring>

#include "core/sim/control_source.h"
#include "core/tet/bad_elements.h"
#include "core/tet/stable_step.h"
#include "tests/support/tet_scenes.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

constexpr std::array<int, 3> kDivisions = {3, 2, 2};
const Vec3 kSize(0.03, 0.02, 0.02);

struct Loaded {
  explicit Loaded(Scene s) : scene(std::move(s)), model(scene) {}
  Scene scene;
  TetModel model;
  ThreadTeam team{1};
  ForceWorkspace corners;
};

Scene SceneOf(const Material& law) {
  Body body = BoxBody(kSize, kDivisions, law);
  body.damping.viscosity = 12;
  body.damping.stiffness_proportional = 1e-3;
  return OneBody(body);
}

std::string NameOf(const Material& law) {
  return std::visit([](const auto& l) { return std::string(l.kName); }, law);
}

class EveryLawTest : public ::testing::TestWithParam<int> {
 protected:
  Material law_ = EveryLaw()[GetParam()];
  Loaded loaded_{SceneOf(law_)};
  const TetModel& model_ = loaded_.model;
  const std::array<double, 1> activation_ = {0.6};
  NodalVector x_ = Shaken(model_.rest_positions(), 1e-3, 7);

  NodalVector ElasticForceAt(const NodalVector& x) {
    NodalVector force;
    ElasticForce(model_, activation_, x, loaded_.team, loaded_.corners, force);
    return force;
  }
};

TEST(EveryLaw, IsTheWholeList) {
  const std::vector<Material> laws = EveryLaw();
  ASSERT_EQ(laws.size(), Laws().size());
  for (std::size_t i = 0; i < laws.size(); ++i) EXPECT_EQ(NameOf(laws[i]), Laws()[i].name);
}

// f = -dW/dx against a sixth-order central difference. Its error is round-off, 1e-11, unless a fibre curve has a kink
// within the stencil; a short stencil makes that error small too.
TEST_P(EveryLawTest, ForceIsMinusGradientOfEnergy) {
  const NodalVector force = ElasticForceAt(x_);
  const double h = 3e-7;
  for (const std::size_t n : {std::size_t{0}, std::size_t{5}, std::size_t{17}}) {
    for (int c = 0; c < 3; ++c) {
      const auto energy = [&](double shift) {
        NodalVector x = x_;
        x[n][c] += shift;
        return ElasticEnergy(model_, 0, activation_, x, loaded_.team);
      };
      const double slope =
          (45 * (energy(h) - energy(-h)) - 9 * (energy(2 * h) - energy(-2 * h)) + (energy(3 * h) - energy(-3 * h))) /
          (60 * h);
      EXPECT_NEAR(force[n][c], -slope, 1e-7 * LargestNorm(force)) << NameOf(law_) << " node " << n << " axis " << c;
    }
  }
}

// Internal forces have no resultant, and no moment if the law is objective.
TEST_P(EveryLawTest, NoResultant) {
  NodalVector force;
  ElasticAndViscousForce(model_, activation_, x_, RandomVectors(model_.nodes(), 3), loaded_.team, loaded_.corners,
                         force);
  Vec3 sum = Vec3::Zero(), moment = Vec3::Zero();
  for (std::size_t n = 0; n < force.size(); ++n) {
    sum += force[n];
    moment += x_[n].cross(force[n]);
  }
  const double size = LargestNorm(force);
  EXPECT_LT(sum.norm(), 1e-13 * size * static_cast<double>(force.size()));
  if (!std::holds_alternative<LinearElastic>(law_)) {
    EXPECT_LT(moment.norm(), 1e-13 * size * kSize.norm() * static_cast<double>(force.size()));
  }
}

// K p against a difference of forces, to the error of the difference.
TEST_P(EveryLawTest, StiffnessIsDerivativeOfForce) {
  TetStiffness stiffness;
  stiffness.Set(model_, activation_, x_, loaded_.team, loaded_.corners);
  const NodalVector p = RandomVectors(model_.nodes(), 11);
  NodalVector product;
  stiffness.Apply(model_, p, loaded_.team, loaded_.corners, product);
  const double h = 1e-8;
  NodalVector ahead = x_, behind = x_;
  for (std::size_t n = 0; n < p.size(); ++n) {
    ahead[n] += h * p[n];
    behind[n] -= h * p[n];
  }
  NodalVector difference = ElasticForceAt(behind);
  const NodalVector force_ahead = ElasticForceAt(ahead);
  for (std::size_t n = 0; n < p.size(); ++n) difference[n] = (difference[n] - force_ahead[n]) / (2 * h);
  EXPECT_LT(LargestDifference(product, difference), 1e-5 * LargestNorm(product)) << NameOf(law_);
}

// A rotated body has no elastic force (except with linear elasticity, which is not objective), and a rotating body no
// viscous force.
TEST_P(EveryLawTest, RigidMotionIsFree) {
  const Mat3 R = Eigen::AngleAxisd(1.1, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  const Vec3 spin(3, -1, 2);
  NodalVector x, v;
  for (const Vec3& X : model_.rest_positions()) {
    x.push_back(R * X + Vec3(0.1, 0, -0.2));
    v.push_back(spin.cross(x.back()) + Vec3(1, 2, 3));
  }
  // Without activation: an active muscle has stress at rest.
  const std::array<double, 1> passive = {0};
  NodalVector force;
  const ForceReport report = ElasticAndViscousForce(model_, passive, x, v, loaded_.team, loaded_.corners, force);
  EXPECT_TRUE(report.valid);
  const double deformed = LargestNorm(ElasticForceAt(x_));
  if (std::holds_alternative<LinearElastic>(law_)) {
    EXPECT_GT(LargestNorm(force), 0.1 * deformed);  // its strain is not invariant under rotation
  } else {
    EXPECT_LT(LargestNorm(force), 1e-10 * deformed);
  }
  EXPECT_LT(report.dissipated_power, 1e-20);
}

INSTANTIATE_TEST_SUITE_P(Laws, EveryLawTest, ::testing::Range(0, kLaws),
                         [](const auto& law) { return NameOf(EveryLaw()[law.param]); });

// A linear displacement on an irregular mesh: uniform stress and no force on interior nodes.
TEST(PatchTest, LinearDisplacementIsInEquilibrium) {
  Body body = BoxBody(kSize, {4, 3, 3}, NeoHookean(std::array{1e4, 0.3}));
  const std::vector<Triangle> surface = BoundaryTriangles(body.tet().mesh);
  std::vector<bool> inside(body.tet().mesh.nodes.size(), true);
  for (const Triangle& t : surface) {
    for (const std::int32_t n : t) inside[n] = false;
  }
  const NodalVector shaken = Shaken(body.tet().mesh.nodes, 1e-3, 5);
  for (std::size_t n = 0; n < inside.size(); ++n) {
    if (inside[n]) body.tet().mesh.nodes[n] = shaken[n];
  }
  Loaded loaded(OneBody(body));
  Mat3 F;
  F << 1.2, 0.1, -0.05, 0.02, 0.9, 0.1, 0.1, -0.1, 1.1;
  NodalVector x;
  for (const Vec3& X : loaded.model.rest_positions()) x.push_back(F * X);
  NodalVector force;
  const std::array<double, 1> activation = {0};
  ElasticForce(loaded.model, activation, x, loaded.team, loaded.corners, force);
  int inner = 0;
  for (std::size_t n = 0; n < inside.size(); ++n) {
    if (!inside[n]) continue;
    ++inner;
    EXPECT_LT(force[n].norm(), 1e-13 * LargestNorm(force));
  }
  EXPECT_GT(inner, 10);
}

// Traction on a side: its nodes get area / 3 of each triangle; the resultant is area times traction.
TEST(LoadTest, TractionIsConsistent) {
  Scene scene = OneBody(BoxBody(kSize, kDivisions, NeoHookean(std::array{1e4, 0.3})));
  scene.bodies[0].loads.push_back({kX1, Traction{Vec3(0, 0, -50)}, Curve::Constant(1), {}});
  scene.bodies[0].loads.push_back({kX1, NodalForce{Vec3(3, 0, 0)}, Curve::Constant(2), {}});
  const TetModel model(scene);
  ThreadTeam team(1);
  NodalVector force;
  ExternalForce(model, ControlSource(scene).At(0), team, force);
  Vec3 sum = Vec3::Zero();
  for (const Vec3& f : force) sum += f;
  EXPECT_NEAR(sum[2], -50 * kSize[1] * kSize[2], 1e-15);
  EXPECT_NEAR(sum[0], 6, 1e-14);
  // All diagonals of the side have the same direction: its corners belong to one or two of the eight triangles.
  const double triangle = kSize[1] * kSize[2] / 8;
  const auto at = [&](double y, double z) {
    for (std::size_t n = 0; n < model.nodes(); ++n) {
      if ((model.rest_positions()[n] - Vec3(kSize[0], y, z)).norm() < 1e-9) return force[n][2];
    }
    return 0.0;
  };
  const double ends = at(0, 0) + at(kSize[1], kSize[2]) + at(0, kSize[2]) + at(kSize[1], 0);
  EXPECT_NEAR(ends, -50 * triangle / 3 * (2 + 2 + 1 + 1), 1e-15);
  EXPECT_NEAR(at(kSize[1] / 2, kSize[2] / 2), -50 * triangle / 3 * 6, 1e-15);
}

TEST(ModelTest, LumpedMassIsAQuarterToEachCorner) {
  const Scene scene = OneBody(BoxBody(kSize, kDivisions, NeoHookean(std::array{1e4, 0.3})));
  const TetModel model(scene);
  double mass = 0;
  for (const double m : model.mass()) mass += m;
  EXPECT_NEAR(mass, 1060 * kSize.prod(), 1e-15);
  const Mat3 Dm = EdgeMatrix(model.rest_positions(), model.corners()[3]);
  EXPECT_LT((model.Bm3(3) * Dm.transpose() + model.rest_volume()[3] * Mat3::Identity()).norm(), 1e-20);
}

// D is linear, symmetric and negative semidefinite, and its diagonal is that of the preconditioner.
TEST(ViscousTest, OperatorAndDiagonal) {
  Loaded loaded(SceneOf(NeoHookean(std::array{1e4, 0.3})));
  const NodalVector x = Shaken(loaded.model.rest_positions(), 1e-3, 1);
  const NodalVector u = RandomVectors(x.size(), 2), v = RandomVectors(x.size(), 3);
  NodalVector Du, Dv, diagonal;
  ViscousForce(loaded.model, x, u, loaded.team, loaded.corners, Du);
  ViscousForce(loaded.model, x, v, loaded.team, loaded.corners, Dv);
  const double vDu = Dot(loaded.team, v, Du), uDv = Dot(loaded.team, u, Dv);
  EXPECT_NEAR(vDu, uDv, 1e-12 * std::abs(Dot(loaded.team, u, Du)));
  EXPECT_LT(Dot(loaded.team, u, Du), 0);
  ViscousDiagonal(loaded.model, x, loaded.team, loaded.corners, diagonal);
  for (std::size_t n = 0; n < x.size(); ++n) {
    for (int c = 0; c < 3; ++c) {
      NodalVector unit(x.size(), Vec3::Zero());
      unit[n][c] = 1;
      ViscousForce(loaded.model, x, unit, loaded.team, loaded.corners, Du);
      EXPECT_NEAR(diagonal[n][c], -Du[n][c], 1e-12 * diagonal[n][c]);
    }
  }
}

TEST(BadElementsTest, NamesThem) {
  Loaded loaded(SceneOf(NeoHookean(std::array{1e4, 0.3})));
  NodalVector x = loaded.model.rest_positions(), force;
  const std::array<double, 1> activation = {0};
  EXPECT_TRUE(ElasticForce(loaded.model, activation, x, loaded.team, loaded.corners, force).valid);
  // A corner of the box is pushed through it, so that its tetrahedra are inverted.
  x[0] = kSize;
  EXPECT_FALSE(ElasticForce(loaded.model, activation, x, loaded.team, loaded.corners, force).valid);
  const BadElements bad = FindBadElements(loaded.model, activation, x);
  EXPECT_TRUE(bad.inverted);
  ASSERT_FALSE(bad.elements.empty());
  for (const std::int64_t e : bad.elements) {
    const Tetrahedron& tet = loaded.scene.bodies[0].tet().mesh.tetrahedra[static_cast<std::size_t>(e)];
    EXPECT_NE(std::find(tet.begin(), tet.end(), 0), tet.end());
  }
}

TEST(ThreadsTest, SameBitsForAnyNumber) {
  Body body = BoxBody(kSize, {20, 16, 16}, EveryLaw()[5]);
  body.damping.viscosity = 1;
  const Scene scene = OneBody(body);
  const TetModel model(scene);
  const NodalVector x = Shaken(model.rest_positions(), 1e-4, 1), v = RandomVectors(model.nodes(), 2);
  const std::array<double, 1> activation = {0.5};
  NodalVector reference;
  double reference_power = 0;
  for (const int threads : {1, 2, 3, 4}) {
    ThreadTeam team(threads);
    ForceWorkspace corners;
    NodalVector force;
    const ForceReport report = ElasticAndViscousForce(model, activation, x, v, team, corners, force);
    if (threads == 1) {
      reference = force;
      reference_power = report.dissipated_power;
    }
    EXPECT_EQ(std::memcmp(reference.data(), force.data(), sizeof(Vec3) * force.size()), 0) << threads;
    EXPECT_EQ(reference_power, report.dissipated_power) << threads;
  }
}

}  // namespace
}  // namespace fascicle
