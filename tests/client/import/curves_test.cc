// The load curves of FEBio models and the controls that follow from them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "model_pieces.h"

namespace fascicle::testing {
namespace {

using client::ImportedScene;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

v1::Curve CurveOf(const std::string& controller) {
  Pieces pieces;
  pieces.curves = controller;
  pieces.boundary +=
      "<bc type=\"prescribed displacement\" node_set=\"t\"><dof>z</dof><value lc=\"1\">1000</value></bc>";
  const ImportedScene imported = Import(pieces);
  if (imported.scene.bodies_size() == 0) return {};
  return imported.scene.bodies(0).constraints(1).motion().translation(0).curve();
}

std::string Controller(const std::string& inner) {
  return "<load_controller id=\"1\" type=\"loadcurve\">" + inner + "</load_controller>";
}

TEST(FebioCurveTest, StepsTakeTheValueOfTheNextPoint) {
  const v1::Curve curve =
      CurveOf(Controller("<interpolate>STEP</interpolate><points><pt>0,0</pt><pt>0.5,1</pt><pt>1,1</pt></points>"));
  ASSERT_EQ(curve.times_size(), 4);
  EXPECT_THAT(curve.values(), ElementsAre(0, 1, 1, 1));
  EXPECT_NEAR(curve.times(1), 0.5e-6, 1e-12);
  EXPECT_EQ(curve.times(2), 0.5);
}

// FEBio's "smooth" curve through points of a parabola is that parabola.
TEST(FebioCurveTest, SmoothCurvesAreSampled) {
  const v1::Curve curve =
      CurveOf(Controller("<interpolate>SMOOTH</interpolate><points><pt>0,0</pt><pt>0.25,0.0625</pt><pt>0.5,0.25</pt>"
                         "<pt>0.75,0.5625</pt><pt>1,1</pt></points>"));
  ASSERT_EQ(curve.times_size(), 81);
  for (int i = 0; i < curve.times_size(); ++i) EXPECT_NEAR(curve.values(i), curve.times(i) * curve.times(i), 1e-12);
}

TEST(FebioCurveTest, SmoothStepsAreSampled) {
  const v1::Curve curve =
      CurveOf(Controller("<interpolate>SMOOTH STEP</interpolate><points><pt>0,0</pt><pt>1,1</pt></points>"));
  ASSERT_EQ(curve.times_size(), 21);
  EXPECT_NEAR(curve.values(10), 0.5, 1e-12);
  EXPECT_NEAR(curve.values(5), 0.103515625, 1e-12);  // w^3 (10 - 15 w + 6 w^2) at 1/4
}

TEST(FebioCurveTest, LinesAreExtrapolatedWhereTheySaySo) {
  const std::string points = "<points><pt>0,0</pt><pt>0.5,1</pt></points>";
  EXPECT_THAT(CurveOf(Controller(points)).times(), ElementsAre(0, 0.5));
  const v1::Curve curve = CurveOf(Controller("<extend>EXTRAPOLATE</extend>" + points));
  EXPECT_THAT(curve.times(), ElementsAre(0, 0.5, 1));
  EXPECT_THAT(curve.values(), ElementsAre(0, 1, 2));
}

// Of a curve with ends at 0.25 and 0.5 in an analysis of one second.
TEST(FebioCurveTest, CurvesRepeat) {
  const std::string points = "<points><pt>0.25,0</pt><pt>0.5,1</pt></points>";
  v1::Curve curve = CurveOf(Controller("<extend>REPEAT</extend>" + points));
  EXPECT_THAT(curve.values(), ElementsAre(0, 1, 0, 1, 0, 1, 0, 1));
  EXPECT_NEAR(curve.times(1), 0.25 - 0.25e-6, 1e-12);
  EXPECT_EQ(curve.times(2), 0.25);
  EXPECT_EQ(curve.times(3), 0.5);
  EXPECT_NEAR(curve.times(4), 0.5 + 0.25e-6, 1e-12);
  EXPECT_EQ(curve.times(7), 1);
  curve = CurveOf(Controller("<extend>REPEAT OFFSET</extend><points><pt>0,0</pt><pt>0.25,1</pt></points>"));
  EXPECT_THAT(curve.times(), ElementsAre(0, 0.25, 0.5, 0.75, 1));
  EXPECT_THAT(curve.values(), ElementsAre(0, 1, 2, 3, 4));
}

// A cubic is its own spline, whatever the spacing of its points; with three points the spline is a parabola.
TEST(FebioCurveTest, CubicSplinesReproduceCubics) {
  const auto cubic = [](double t) { return t * (1 + t * (2 - 3 * t)); };
  std::string points;
  for (const double t : {0.0, 0.1, 0.35, 0.5, 0.85, 1.0}) {
    points += "<pt>" + std::to_string(t) + "," + std::to_string(cubic(t)) + "</pt>";
  }
  v1::Curve curve = CurveOf(Controller("<interpolate>CUBIC SPLINE</interpolate><points>" + points + "</points>"));
  ASSERT_GE(curve.times_size(), 100);
  for (int i = 0; i < curve.times_size(); ++i) EXPECT_NEAR(curve.values(i), cubic(curve.times(i)), 1e-5);
  curve = CurveOf(
      Controller("<interpolate>CUBIC SPLINE</interpolate><points><pt>0,0</pt><pt>0.5,0.25</pt><pt>1,1</pt></points>"));
  for (int i = 0; i < curve.times_size(); ++i) {
    EXPECT_NEAR(curve.values(i), curve.times(i) * curve.times(i), 1e-12);
  }
}

std::string Formula(const std::string& formula) {
  return "<load_controller id=\"1\" type=\"math\"><math>" + formula + "</math></load_controller>";
}

TEST(FebioCurveTest, FormulasOfTime) {
  v1::Curve curve = CurveOf(Formula("2*t"));
  EXPECT_THAT(curve.times(), ElementsAre(0, 1));
  EXPECT_THAT(curve.values(), ElementsAre(0, 2));
  curve = CurveOf(Formula("0.5*(1 - cos(2*pi*t)) + 3e-1*t^2 - max(t, 0)*-1"));
  ASSERT_EQ(curve.times_size(), 1001);
  for (int i = 0; i < curve.times_size(); ++i) {
    const double t = curve.times(i);
    EXPECT_NEAR(curve.values(i), 0.5 * (1 - std::cos(2 * M_PI * t)) + 0.3 * t * t + t, 1e-12);
  }
  curve = CurveOf(
      "<load_controller id=\"1\" type=\"math-interval\"><interval>0,0.5</interval><right_extend>zero</right_extend>"
      "<math>t</math></load_controller>");
  EXPECT_THAT(curve.values(), ElementsAre(0, 0.5, 0));
  Pieces pieces;
  pieces.boundary += "<bc type=\"prescribed displacement\" node_set=\"t\"><dof>z</dof><value lc=\"1\">1</value></bc>";
  for (const auto& [formula, message] :
       {std::pair("X*t", "depends on `X`"), std::pair("sin(t", "is not a formula"), std::pair("1/t", "is not finite"),
        std::pair("((((((((((((((((((((((((((((((((((((((((((((((((((t", "is too long")}) {
    pieces.curves = Formula(formula);
    EXPECT_THAT(Refusal(pieces), HasSubstr(message)) << formula;
  }
  pieces.curves = Formula("t");
  pieces.boundary +=
      "<bc type=\"prescribed displacement\" node_set=\"t\"><dof>x</dof><value lc=\"1\" type=\"math\">2*3</value></bc>";
  EXPECT_NEAR(Import(pieces).scene.bodies(0).constraints(1).motion().translation(0).curve().values(1), 6e-3, 1e-15);
}

// The parabolas of a smooth curve fall below 0 beside its flat piece.
TEST(FebioCurveTest, ActivationsBelowZeroAreZero) {
  Pieces pieces;
  pieces.material =
      "<material id=\"1\" name=\"m\" type=\"uncoupled solid mixture\"><k>10</k><solid type=\"Mooney-Rivlin\"><c1>1</c1>"
      "</solid><solid type=\"muscle material\"><p1>0.05</p1><p2>6.6</p2><Lofl>1</Lofl><smax>0.3</smax><lam_max>1.4"
      "</lam_max><activation lc=\"1\">1</activation></solid></material>";
  pieces.curves = Controller(
      "<interpolate>SMOOTH</interpolate><points><pt>0,0</pt><pt>0.25,0</pt><pt>0.5,0.5</pt><pt>1,0.5</pt></points>");
  const ImportedScene imported = Import(pieces);
  double lowest = 1;
  for (const double value : imported.scene.bodies(0).activation().values()) lowest = std::min(lowest, value);
  EXPECT_EQ(lowest, 0);
  EXPECT_THAT(NoticesOf(imported), HasSubstr("activations below 0 are taken as 0"));
}

// What the activation exceeds 1 by goes to the peak stress; the passive stress, which is relative to it, stays.
TEST(FebioCurveTest, ActivationsAboveOneScaleTheStress) {
  Pieces pieces;
  pieces.material =
      "<material id=\"1\" name=\"m\" type=\"uncoupled solid mixture\"><k>10</k><solid type=\"Mooney-Rivlin\"><c1>1</c1>"
      "</solid><solid type=\"muscle material\"><p1>0.05</p1><p2>6.6</p2><Lofl>1</Lofl><smax>0.3</smax><lam_max>1.4"
      "</lam_max><activation lc=\"1\">1</activation></solid></material>";
  const v1::Body body = Import(pieces).scene.bodies(0);  // the load curve reaches 2
  EXPECT_THAT(body.activation().values(), ElementsAre(0, 1));
  EXPECT_DOUBLE_EQ(body.material().muscle().peak_stress(), 0.6e6);
  EXPECT_DOUBLE_EQ(body.material().muscle().passive_scale(), 0.025);
}

TEST(FebioCurveTest, MotionsStartAtRest) {
  const v1::Curve curve = CurveOf(Controller("<points><pt>0,1</pt><pt>1,3</pt></points>"));
  EXPECT_THAT(curve.times(), ElementsAre(0, 0.25, 1));
  EXPECT_THAT(curve.values(), ElementsAre(0, 1.5, 3));
}

}  // namespace
}  // namespace fascicle::testing
