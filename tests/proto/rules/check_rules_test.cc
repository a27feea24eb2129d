#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fascicle/v1/job.pb.h"
#include "fascicle/v1/scene.pb.h"
#include "proto/rules/field_rules.h"

namespace fascicle {
namespace {

using ::testing::HasSubstr;

// The only problem at `path`, or an empty one.
Problem At(const Problems& problems, const std::string& path) {
  Problem found;
  int count = 0;
  for (const Problem& problem : problems.kept()) {
    if (problem.path == path) {
      found = problem;
      ++count;
    }
  }
  EXPECT_EQ(count, 1) << path << " in\n" << problems.ToString();
  return found;
}

// Obeys every rule.
v1::Scene GoodScene() {
  v1::Scene scene;
  scene.set_duration(1);
  scene.mutable_tet();
  scene.mutable_output()->set_frame_interval(0.1);
  v1::Body& body = *scene.add_bodies();
  for (int i = 0; i < 3; ++i) body.mutable_mesh()->mutable_box()->add_size(0.1);
  body.mutable_material()->mutable_neo_hookean()->set_young_modulus(1e4);
  return scene;
}

TEST(CheckRules, AcceptsAGoodScene) {
  Problems problems;
  CheckRules(GoodScene(), problems);
  EXPECT_TRUE(problems.empty()) << problems.ToString();
}

TEST(CheckRules, NamesEveryProblemAtOnce) {
  v1::Scene scene = GoodScene();
  scene.clear_duration();
  scene.clear_tet();
  scene.mutable_gravity();
  v1::Body& body = *scene.mutable_bodies(0);
  body.set_density(-1060);
  body.mutable_mesh()->mutable_box()->add_size(1);
  body.mutable_mesh()->mutable_box()->add_divisions(0);
  body.mutable_material()->mutable_neo_hookean()->set_poisson_ratio(0.5);
  body.mutable_damping()->set_viscosity(std::numeric_limits<double>::quiet_NaN());
  body.set_unit(static_cast<v1::LengthUnit>(99));
  body.mutable_activation()->add_values(std::numeric_limits<double>::infinity());
  body.add_loads()->mutable_traction()->add_vector(1);
  Problems problems;
  CheckRules(scene, problems);

  EXPECT_THAT(At(problems, "duration").message, HasSubstr("missing or 0"));
  EXPECT_THAT(At(problems, "duration").hint, HasSubstr("unit s, range (0, 1000], required"));
  EXPECT_THAT(At(problems, "method").hint, HasSubstr("tet"));
  EXPECT_THAT(At(problems, "gravity.acceleration").message, HasSubstr("missing"));
  EXPECT_EQ(At(problems, "bodies[0].density").message, "is -1060, outside the range (0, 30000]");
  EXPECT_THAT(At(problems, "bodies[0].density").hint, HasSubstr("unit kg/m^3, range (0, 30000], default 1060"));
  EXPECT_EQ(At(problems, "bodies[0].mesh.box.size").message, "has 4 values instead of 3");
  EXPECT_EQ(At(problems, "bodies[0].mesh.box.divisions").message, "has 1 values instead of 3");
  EXPECT_THAT(At(problems, "bodies[0].mesh.box.divisions[0]").message, HasSubstr("outside the range [1, 1000]"));
  EXPECT_THAT(At(problems, "bodies[0].material.neo_hookean.poisson_ratio").message, HasSubstr("(-1, 0.5)"));
  EXPECT_THAT(At(problems, "bodies[0].damping.viscosity").message, HasSubstr("finite"));
  EXPECT_THAT(At(problems, "bodies[0].unit").message, HasSubstr("not a value of LengthUnit"));
  EXPECT_THAT(At(problems, "bodies[0].activation.times").message, HasSubstr("missing"));
  EXPECT_THAT(At(problems, "bodies[0].activation.values[0]").message, HasSubstr("finite"));
  EXPECT_THAT(At(problems, "bodies[0].loads[0].traction.vector").message, HasSubstr("1 values instead of 3"));
  EXPECT_EQ(problems.count(), 13u) << problems.ToString();
}

TEST(CheckRules, OpenAndClosedEndsDiffer) {
  const auto count = [](double poisson, double c2) {
    v1::Scene scene = GoodScene();
    scene.mutable_bodies(0)->mutable_material()->mutable_neo_hookean()->set_poisson_ratio(poisson);
    v1::MooneyRivlin& law = *scene.add_bodies()->mutable_material()->mutable_mooney_rivlin();
    law.set_c1(1e12);
    law.set_bulk_modulus(1);
    law.set_c2(c2);
    Problems problems;
    CheckRules(scene, problems);
    return problems.count();
  };
  EXPECT_EQ(count(0.499999, 0), 0u);
  EXPECT_EQ(count(0.5, 0), 1u);
  EXPECT_EQ(count(-1, 0), 1u);
  EXPECT_EQ(count(0, -1e-300), 1u);
}

TEST(CheckRules, ZeroStandsForAbsentWithoutPresence) {
  v1::Job job;
  Problems problems;
  CheckRules(job, problems);  // threads: 0 is in its range
  EXPECT_TRUE(problems.empty()) << problems.ToString();
  job.set_threads(257);
  CheckRules(job, problems);
  EXPECT_EQ(problems.count(), 1u);
}

TEST(FillDefaults, SetsWhatIsAbsentAndNothingElse) {
  v1::Scene scene = GoodScene();
  scene.mutable_bodies(0)->mutable_material()->mutable_neo_hookean()->set_poisson_ratio(0);
  scene.add_bodies()->set_density(1);
  scene.mutable_bodies(1)->mutable_material()->mutable_muscle()->set_c1(7);
  FillDefaults(scene);
  const v1::Body& box = scene.bodies(0);
  EXPECT_EQ(box.density(), 1060);
  EXPECT_EQ(box.mesh().box().divisions_size(), 3);
  EXPECT_EQ(box.mesh().box().divisions(2), 8);
  EXPECT_EQ(box.mesh().box().origin_size(), 3);
  EXPECT_EQ(box.mesh().box().size_size(), 3);
  EXPECT_TRUE(box.material().neo_hookean().has_poisson_ratio());
  EXPECT_EQ(box.material().neo_hookean().poisson_ratio(), 0);
  EXPECT_FALSE(box.has_damping());
  EXPECT_EQ(scene.bodies(1).density(), 1);
  EXPECT_EQ(scene.bodies(1).material().muscle().c1(), 7);
  EXPECT_EQ(scene.bodies(1).material().muscle().bulk_modulus(), 1e7);
  EXPECT_EQ(scene.tet().safety(), 0.9);
  EXPECT_FALSE(scene.tet().has_time_step());
  EXPECT_FALSE(scene.output().has_settle_speed());

  v1::Scene again = scene;
  FillDefaults(again);
  EXPECT_EQ(again.SerializeAsString(), scene.SerializeAsString());
}

}  // namespace
}  // namespace fascicle
