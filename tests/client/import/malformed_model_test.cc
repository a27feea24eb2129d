// Wrong models: each mistake is reported with its line and element, all of them at once.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "client/import/febio_import.h"
#include "tests/support/sample_models.h"

namespace fascicle::testing {
namespace {

using ::testing::HasSubstr;

std::string Replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return at == std::string::npos ? text : text.replace(at, what.size(), by);
}

// The line at which a piece of text begins.
long LineOf(const std::string& text, const std::string& piece) {
  const std::size_t at = text.find(piece);
  EXPECT_NE(at, std::string::npos) << piece;
  return 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
}

struct Mistake {
  std::string name;
  std::string what, by;  // the model with one piece of it replaced
  std::string at;        // the text of the reported line
  std::string element;   // the end of the path
  std::string message, hint;
};

const std::vector<Mistake>& Mistakes() {
  static const std::vector<Mistake> mistakes = {
      {"Version", "4.0", "2.0", "<febio_spec", "model.feb:2", "`2.0`", "4.0, 3.0 and 2.5"},
      {"Module", "\"solid\"", "\"biphasic\"", "<Module", "Module `biphasic`", "not supported", "solids only"},
      {"Units", "<Module type=\"solid\"/>", "<Module type=\"solid\"><units>furlong</units></Module>", "<Module",
       "units", "`furlong`", "--units"},
      {"NoStepSize", "<step_size>0.1</step_size>", "", "<Control>", "Control", "has no step_size", "<step_size>"},
      {"NegativeSteps", "<time_steps>10<", "<time_steps>-3<", "<time_steps>", "Control/time_steps", "is not positive",
       ""},
      {"StepIsNoNumber", "<step_size>0.1<", "<step_size>fast<", "<step_size>", "Control/step_size", "`fast`", ""},
      {"Analysis", "STATIC", "MODAL", "<analysis>", "Control/analysis", "`modal`", "static and dynamic"},
      {"UnknownMaterial", "type=\"Mooney-Rivlin\"", "type=\"Gent\"", "<material", "material `rubber`", "`Gent`",
       "Mooney-Rivlin"},
      {"MuscleMaterial", "type=\"Mooney-Rivlin\"", "type=\"muscle material\"", "<material", "material `rubber`",
       "has no matrix", "uncoupled solid mixture"},
      {"NoBulkModulus", "<k>80</k>", "", "<material", "material `rubber`", "has no k", "<k>"},
      {"ParameterIsNoNumber", "<c1>0.03", "<c1>0.03 MPa", "<c1>", "material `rubber`/c1", "`MPa`", ""},
      {"ParameterInTime", "<c1>", "<c1 lc=\"1\">", "<c1", "material `rubber`/c1", "changes in time", "remove lc"},
      {"ParameterOutOfRange", "<c1>0.03", "<c1>-0.03", "<material", "material `rubber`",
       "bodies[0].material.mooney_rivlin.c1", ""},
      {"MaterialTwice", "    </material>\n",
       "    </material>\n    <material id=\"2\" name=\"rubber\" type=\"neo-Hookean\"><E>1</E><v>0</v></material>\n",
       "<material id=\"2\"", "material `rubber`", "already", "uniquely"},
      {"TwoCoordinates", "0,10,0<", "0,10<", "<node id=\"3\"", "Mesh/Nodes `all`/node `3`", "has 2 numbers where 3",
       ""},
      {"CoordinateIsNaN", "0,10,0<", "0,nan,0<", "<node id=\"3\"", "node `3`", "`nan`", ""},
      {"NodeTwice", "<node id=\"5\"", "<node id=\"4\"", "<node id=\"4\">10", "node `4`", "given twice", "uniquely"},
      {"NodeWithoutId", "<node id=\"2\"", "<node", "<node>", "node", "has no id", "id="},
      {"UnknownNode", "2,3,4,5<", "2,3,4,7<", "2,3,4,7", "Elements `block`/elem `2`", "node 7, which does not exist",
       ""},
      {"ElementOfThreeNodes", "2,3,4,5<", "2,3,4<", "<elem id=\"2\"", "elem `2`", "has 3 numbers where 4", ""},
      {"ElementWithANodeTwice", "2,3,4,5<", "2,3,5,5<", "<elem id=\"2\"", "elem `2`", "has a node twice", ""},
      {"InvertedElement", "2,3,4,5<", "3,2,4,5<", "<elem id=\"2\"", "elem `2`", "inverted or flat", "mesh"},
      {"Wedges", "type=\"tet4\"", "type=\"penta6\"", "<Elements", "Elements `block`", "`penta6`", "--split-hexahedra"},
      {"HigherOrder", "type=\"tet4\"", "type=\"tet15\"", "<Elements", "Elements `block`", "`tet15`", "tet10"},
      {"SetOfUnknownNode", "\"bottom\">1,2,3", "\"bottom\">1,2,30", "<NodeSet name=\"bottom\"", "NodeSet `bottom`",
       "node 30", ""},
      {"SetTwice", "<NodeSet name=\"top\">", "<NodeSet name=\"bottom\">", "<NodeSet name=\"bottom\">5",
       "NodeSet `bottom`", "already", "uniquely"},
      {"UnknownFacet", "<tri3 id=\"1\">1,3,2</tri3>", "<hexagon id=\"1\">1,3,2</hexagon>", "<hexagon", "hexagon `1`",
       "is not a facet", "tri3"},
      {"NoSuchPart", "<SolidDomain name=\"block\"", "<SolidDomain name=\"blok\"", "<SolidDomain", "SolidDomain `blok`",
       "no part `blok`", "Elements"},
      {"NoSuchMaterial", "mat=\"rubber\"", "mat=\"steel\"", "<SolidDomain", "SolidDomain `block`",
       "no material `steel`", "`rubber`"},
      {"PartWithoutMaterial", "<SolidDomain name=\"block\" mat=\"rubber\"/>", "", "<Elements", "Elements `block`",
       "gives this part a material", "MeshDomains"},
      {"NoSuchNodeSet", "node_set=\"bottom\"", "node_set=\"botom\"", "<bc type=\"zero", "bc `zero displacement`",
       "no node set `botom`", "@surface"},
      {"NothingHeld", "<x_dof>1</x_dof><y_dof>1</y_dof><z_dof>1</z_dof>", "<x_dof>0</x_dof>", "<bc type=\"zero",
       "bc `zero displacement`", "contains no direction", "x_dof"},
      {"FlagIsNoFlag", "<x_dof>1", "<x_dof>yes", "<x_dof>", "bc `zero displacement`/x_dof", "`yes`", ""},
      {"NoDirection", "<dof>z</dof>", "<dof>w</dof>", "<dof>w", "dof", "`w` is not a direction", "x, y or z"},
      {"ContraryMotion", "<NodeSet name=\"top\">5", "<NodeSet name=\"top\">5,3", "<bc type=\"pres",
       "bc `prescribed displacement`", "node 3 along z differently from line 38", "out of one"},
      {"NoSuchController", "<value lc=\"1\">", "<value lc=\"4\">", "<value", "bc `prescribed displacement`/value",
       "load controller 4 does not exist", "LoadData"},
      {"ControllerIsNoNumber", "<value lc=\"1\">", "<value lc=\"one\">", "<value", "value", "`one`, not a whole number",
       ""},
      {"MotionTooFar", ">1.0</value>", ">1e6</value>", "<value", "value", "reaches 1000", "in SI"},
      {"MappedValue", "<value lc=\"1\">", "<value lc=\"1\" type=\"map\">", "<value", "value `map`", "`map`",
       "constant"},
      {"NoSuchSurface", "surface=\"side\"", "surface=\"sied\"", "<surface_load", "surface_load `traction`",
       "no surface `sied`", "Surface"},
      {"NoTraction", "<traction>0,0,0.001</traction>", "", "<surface_load", "surface_load `traction`",
       "has no traction", "<traction>"},
      {"PointOutOfOrder", "<pt>1,1</pt>", "<pt>-1,1</pt>", "<pt>-1", "load_controller `1`/points/pt", "not later",
       "by time"},
      {"PointOfThreeNumbers", "<pt>1,1</pt>", "<pt>1,1,1</pt>", "<pt>1,1,1", "pt", "has 3 numbers where 2", ""},
      {"NoPoints", "<pt>0,0</pt>\n        <pt>1,1</pt>", "", "<load_controller", "load_controller `1`", "no points",
       "<points>"},
      {"MathController", "type=\"loadcurve\"", "type=\"math\"", "<value", "value", "not a formula",
       "linear load curve"},
      {"OtherFile", "<MeshDomains>", "<Include>part.feb</Include>\n  <MeshDomains>", "<Include>", "Include",
       "another file", "here"},
  };
  return mistakes;
}

class MalformedModelTest : public ::testing::TestWithParam<Mistake> {};

TEST_P(MalformedModelTest, IsToldWithItsLine) {
  const Mistake& mistake = GetParam();
  const std::string text = Replaced(kSmallModel, mistake.what, mistake.by);
  Problems problems;
  EXPECT_FALSE(client::ImportFebio(text, {}, problems).has_value());
  const std::string line = "model.feb:" + std::to_string(LineOf(text, mistake.at));
  bool found = false;
  for (const Problem& problem : problems.kept()) {
    const bool here = problem.path == line || problem.path.starts_with(line + ": ");
    if (!here || problem.message.find(mistake.message) == std::string::npos) continue;
    found = true;
    EXPECT_TRUE(problem.path.ends_with(mistake.element)) << problem.path;
    EXPECT_THAT(problem.hint, HasSubstr(mistake.hint));
  }
  EXPECT_TRUE(found) << "expected " << line << ": ..." << mistake.element << ": ..." << mistake.message << " in\n"
                     << problems.ToString();
  EXPECT_LE(problems.count(), 3u) << problems.ToString();
}

INSTANTIATE_TEST_SUITE_P(Mistakes, MalformedModelTest, ::testing::ValuesIn(Mistakes()),
                         [](const auto& instance) { return instance.param.name; });

TEST(MalformedModelTest, TheModelItselfIsRight) {
  Problems problems;
  const auto imported = client::ImportFebio(kSmallModel, {}, problems);
  ASSERT_TRUE(imported.has_value()) << problems.ToString();
  EXPECT_TRUE(imported->notices.empty()) << imported->notices.front().where << imported->notices.front().message;
}

TEST(MalformedModelTest, AllMistakesAreToldAtOnce) {
  std::string text = kSmallModel;
  const std::vector<std::string> mistakes = {"NegativeSteps", "NoBulkModulus", "TwoCoordinates",     "NoSuchMaterial",
                                             "NoDirection",   "NoSuchSurface", "PointOfThreeNumbers"};
  std::vector<std::string> messages;
  for (const Mistake& mistake : Mistakes()) {
    if (std::find(mistakes.begin(), mistakes.end(), mistake.name) == mistakes.end()) continue;
    text = Replaced(text, mistake.what, mistake.by);
    messages.push_back(mistake.message);
  }
  ASSERT_EQ(messages.size(), mistakes.size());
  Problems problems;
  EXPECT_FALSE(client::ImportFebio(text, {}, problems).has_value());
  for (const std::string& message : messages) EXPECT_THAT(problems.ToString(), HasSubstr(message));
  EXPECT_LE(problems.count(), messages.size() + 2) << problems.ToString();
}

TEST(MalformedModelTest, WhatIsNoModelIsRefused) {
  const std::vector<std::pair<std::string, std::string>> texts = {
      {"", "model.feb:1: this is not XML"},
      {"solid cube\nfacet normal 0 0 1\n", "this is not XML"},
      {"<?xml version=\"1.0\"?>\n<febio_spec version=\"4.0\">\n  <Mesh>\n", "model.feb:"},
      {"<VTKFile type=\"UnstructuredGrid\"/>", "`VTKFile`"},
      {std::string("\xFF\xFE<\0f\0", 6), "UTF-16"},
      {std::string(kSmallModel).substr(0, 900), "is the file complete?"},
      {"<!DOCTYPE a [<!ENTITY x SYSTEM \"file:///etc/passwd\">]><febio_spec version=\"4.0\">&x;</febio_spec>",
       "has no Mesh section"}};
  for (const auto& [text, message] : texts) {
    Problems problems;
    EXPECT_FALSE(client::ImportFebio(text, {}, problems).has_value());
    EXPECT_THAT(problems.ToString(), HasSubstr(message));
    EXPECT_THAT(problems.ToString(), ::testing::Not(HasSubstr("root:")));
  }
}

// Deep nesting and a file full of mistakes need neither a deep stack nor much time.
TEST(MalformedModelTest, HostileFilesEnd) {
  std::string deep = "<febio_spec version=\"4.0\">";
  for (int k = 0; k < 200'000; ++k) deep += "<a>";
  for (int k = 0; k < 200'000; ++k) deep += "</a>";
  deep += "</febio_spec>";
  std::string many = Replaced(kSmallModel, "    </Nodes>\n", "");
  std::string nodes;
  for (int k = 0; k < 100'000; ++k) nodes += "<node>x</node>";
  many = Replaced(many, "    <Elements", nodes + "</Nodes>\n    <Elements");
  for (const std::string& text : {deep, many}) {
    Problems problems;
    EXPECT_FALSE(client::ImportFebio(text, {}, problems).has_value());
    EXPECT_LE(problems.kept().size(), Problems::kMaxKept);
  }
}

}  // namespace
}  // namespace fascicle::testing
