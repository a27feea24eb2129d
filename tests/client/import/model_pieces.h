#ifndef FASCICLE_TESTS_CLIENT_IMPORT_MODEL_PIECES_H_
#define FASCICLE_TESTS_CLIENT_IMPORT_MODEL_PIECES_H_

#include <gtest/gtest.h>

#include <string>

#include "client/import/febio_import.h"

// Small FEBio models as text, and what becomes of them.
namespace fascicle::testing {

// A model made of pieces; each piece has a working default.
struct Pieces {
  std::string version = "4.0";
  std::string module = "<Module type=\"solid\"/>";
  std::string control = "<Control><time_steps>4</time_steps><step_size>0.25</step_size></Control>";
  std::string material = "<material id=\"1\" name=\"m\" type=\"neo-Hookean\"><E>1</E><v>0.3</v></material>";
  std::string nodes =
      "<node id=\"1\">0,0,0</node><node id=\"2\">10,0,0</node><node id=\"3\">0,10,0</node>"
      "<node id=\"4\">0,0,10</node><node id=\"5\">10,10,10</node>";
  std::string elements =
      "<Elements type=\"tet4\" name=\"p\"><elem id=\"1\">1,2,3,4</elem><elem id=\"2\">2,3,4,5</elem></Elements>";
  std::string sets = "<NodeSet name=\"s\">1,2,3</NodeSet><NodeSet name=\"t\">5</NodeSet>";
  std::string domains = "<SolidDomain name=\"p\" mat=\"m\"/>";
  std::string data;
  std::string boundary = "<bc type=\"zero displacement\" node_set=\"s\"><x_dof>1</x_dof></bc>";
  std::string loads;
  std::string curves =
      "<load_controller id=\"1\" type=\"loadcurve\"><points><pt>0,0</pt><pt>1,2</pt></points></load_controller>";
  std::string rest;

  std::string Model() const {
    return "<febio_spec version=\"" + version + "\">" + module + control + "<Material>" + material +
           "</Material><Mesh><Nodes>" + nodes + "</Nodes>" + elements + sets + "</Mesh><MeshDomains>" + domains +
           "</MeshDomains><MeshData>" + data + "</MeshData><Boundary>" + boundary + "</Boundary><Loads>" + loads +
           "</Loads><LoadData>" + curves + "</LoadData>" + rest + "</febio_spec>";
  }
};

// The scene, with losses.
inline client::ImportedScene Import(const Pieces& pieces, const client::FebioOptions& options = {}) {
  client::FebioOptions lenient = options;
  lenient.accept_loss = true;
  Problems problems;
  auto imported = client::ImportFebio(pieces.Model(), lenient, problems);
  EXPECT_TRUE(imported.has_value()) << problems.ToString();
  return imported ? *imported : client::ImportedScene();
}

inline std::string Refusal(const Pieces& pieces, const client::FebioOptions& options = {}) {
  Problems problems;
  EXPECT_FALSE(client::ImportFebio(pieces.Model(), options, problems).has_value());
  return problems.ToString();
}

// "KIND where: message" of each notice.
inline std::string NoticesOf(const client::ImportedScene& imported) {
  std::string text;
  for (const client::Notice& notice : imported.notices) {
    const char* kind = notice.kind == client::Notice::Kind::kNotTaken  ? "unsupported "
                       : notice.kind == client::Notice::Kind::kChanged ? "changed "
                                                                       : "note ";
    text += kind + notice.where + ": " + notice.message + "\n";
  }
  return text;
}

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_CLIENT_IMPORT_MODEL_PIECES_H_
