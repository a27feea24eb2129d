#ifndef FASCICLE_TESTS_SUPPORT_FEB_WRITER_H_
#define FASCICLE_TESTS_SUPPORT_FEB_WRITER_H_

#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/geometry/shapes.h"

// Writes FEBio models of versions 2.5, 3.0 and 4.0 for tests, among others the reference problems.
namespace fascicle::testing {

using Point = std::array<double, 3>;

struct FebMesh {
  std::string type;  // "tet4", "tet10", "hex8"
  std::vector<Point> nodes;
  std::vector<std::vector<int>> elements;  // counted from 0
  std::vector<Point> fibres;               // one for each element, or none
};

inline std::string Text(double number) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.17g", number);
  return text;
}

inline std::string Text(const Point& p) { return Text(p[0]) + "," + Text(p[1]) + "," + Text(p[2]); }

// "1,2,3" of nodes counted from 0.
inline std::string Ids(const std::vector<int>& nodes) {
  std::string text;
  for (const int n : nodes) text += (text.empty() ? "" : ",") + std::to_string(n + 1);
  return text;
}

class FebWriter {
 public:
  FebWriter(std::string version, FebMesh mesh) : version_(std::move(version)), mesh_(std::move(mesh)) {}

  bool is_version_2() const { return version_ == "2.5"; }
  bool is_version_3() const { return version_ == "3.0"; }
  const FebMesh& mesh() const { return mesh_; }

  // Nodes for which `inside` holds.
  std::vector<int> Nodes(const std::function<bool(const Point&)>& inside) const {
    std::vector<int> nodes;
    for (std::size_t n = 0; n < mesh_.nodes.size(); ++n) {
      if (inside(mesh_.nodes[n])) nodes.push_back(static_cast<int>(n));
    }
    return nodes;
  }

  void AddNodeSet(const std::string& name, const std::vector<int>& nodes) {
    sets_ += "    <NodeSet name=\"" + name + "\">";
    if (is_version_2()) {
      for (const int n : nodes) sets_ += "<node id=\"" + std::to_string(n + 1) + "\"/>";
    } else {
      sets_ += Ids(nodes);
    }
    sets_ += "</NodeSet>\n";
  }
  void AddSurface(const std::string& name, const std::string& kind, const std::vector<std::vector<int>>& facets) {
    sets_ += "    <Surface name=\"" + name + "\">\n";
    int id = 0;
    for (const std::vector<int>& facet : facets) {
      sets_ += "      <" + kind + " id=\"" + std::to_string(++id) + "\">" + Ids(facet) + "</" + kind + ">\n";
    }
    sets_ += "    </Surface>\n";
  }
  // The content of <material>.
  void SetMaterial(const std::string& type, const std::string& content) {
    material_ = "    <material id=\"1\" name=\"tissue\" type=\"" + type + "\">\n" + content + "    </material>\n";
  }
  void Fix(const std::string& set, const std::string& axes) {
    if (is_version_2()) {
      boundary_ += "    <fix bc=\"" + Listed(axes) + "\" node_set=\"" + set + "\"/>\n";
      return;
    }
    boundary_ += "    <bc name=\"fix " + set + "\" node_set=\"" + set + "\" type=\"";
    if (is_version_3()) {
      boundary_ += "fix\"><dofs>" + Listed(axes) + "</dofs></bc>\n";
      return;
    }
    boundary_ += "zero displacement\">";
    for (const char axis : std::string("xyz")) {
      const std::string name = std::string(1, axis) + "_dof";
      boundary_ += "<" + name + ">" + (axes.find(axis) == std::string::npos ? "0" : "1") + "</" + name + ">";
    }
    boundary_ += "</bc>\n";
  }
  void Move(const std::string& set, char axis, double value) {
    if (is_version_2()) {
      boundary_ += "    <prescribe bc=\"" + std::string(1, axis) + "\" node_set=\"" + set + "\"><scale lc=\"1\">" +
                   Text(value) + "</scale><relative>0</relative></prescribe>\n";
      return;
    }
    const std::string tag = is_version_3() ? "scale" : "value";
    boundary_ += "    <bc node_set=\"" + set + "\" type=\"" +
                 (is_version_3() ? "prescribe" : "prescribed displacement") + "\"><dof>" + axis + "</dof><" + tag +
                 " lc=\"1\">" + Text(value) + "</" + tag + "><relative>0</relative></bc>\n";
  }
  void AddLoad(const std::string& content) { loads_ += "    " + content + "\n"; }

  std::string Model() const {
    std::string out = "<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>\n<febio_spec version=\"" + version_ +
                      "\">\n  <Module type=\"solid\"/>\n";
    out +=
        "  <Control>\n    <analysis>STATIC</analysis>\n    <time_steps>10</time_steps>\n    "
        "<step_size>0.1</step_size>\n    <solver><symmetric_stiffness>0</symmetric_stiffness></solver>\n  </Control>\n";
    const std::string mesh = is_version_2() ? "Geometry" : "Mesh";
    out += "  <Material>\n" + material_ + "  </Material>\n  <" + mesh + ">\n    <Nodes name=\"Object1\">\n";
    for (std::size_t n = 0; n < mesh_.nodes.size(); ++n) {
      out += "      <node id=\"" + std::to_string(n + 1) + "\">" + Text(mesh_.nodes[n]) + "</node>\n";
    }
    out += "    </Nodes>\n    <Elements type=\"" + mesh_.type + "\"" + (is_version_2() ? " mat=\"1\"" : "") +
           " name=\"belly\">\n";
    for (std::size_t e = 0; e < mesh_.elements.size(); ++e) {
      out += "      <elem id=\"" + std::to_string(e + 1) + "\">" + Ids(mesh_.elements[e]) + "</elem>\n";
    }
    out += "    </Elements>\n" + sets_ + "  </" + mesh + ">\n";
    if (!is_version_2()) out += "  <MeshDomains>\n    <SolidDomain name=\"belly\" mat=\"tissue\"/>\n  </MeshDomains>\n";
    out += MeshData();
    out += "  <Boundary>\n" + boundary_ + "  </Boundary>\n  <Loads>\n" + loads_ + "  </Loads>\n";
    out +=
        is_version_2()
            ? "  <LoadData>\n    <loadcurve id=\"1\" type=\"linear\"><point>0,0</point><point>1,1</point></loadcurve>\n"
              "  </LoadData>\n"
            : "  <LoadData>\n    <load_controller id=\"1\" type=\"loadcurve\">\n"
              "      <interpolate>LINEAR</interpolate>\n      <points>\n        <point>0,0</point>\n"
              "        <point>1,1</point>\n      </points>\n    </load_controller>\n  </LoadData>\n";
    return out + "  <Output><plotfile type=\"febio\"><var type=\"displacement\"/></plotfile></Output>\n</febio_spec>\n";
  }

 private:
  static std::string Listed(const std::string& axes) {
    std::string list;
    for (const char axis : axes) list += (list.empty() ? "" : ",") + std::string(1, axis);
    return list;
  }

  std::string MeshData() const {
    if (mesh_.fibres.empty()) return "";
    std::string out = "  <MeshData>\n    <ElementData ";
    out += std::string(is_version_3() || is_version_2() ? "var" : "type") + "=\"fiber\" elem_set=\"belly\">\n";
    for (std::size_t e = 0; e < mesh_.fibres.size(); ++e) {
      out += "      <elem lid=\"" + std::to_string(e + 1) + "\">" + Text(mesh_.fibres[e]) + "</elem>\n";
    }
    return out + "    </ElementData>\n  </MeshData>\n";
  }

  std::string version_;
  FebMesh mesh_;
  std::string material_, sets_, boundary_, loads_;
};

// The box of the reference problems, with x fastest and hexahedra split around one diagonal.
inline FebMesh Box(const Vec3& size, const std::array<int, 3>& divisions) {
  const TetMesh box = MakeBox(Vec3::Zero(), size, divisions);
  FebMesh mesh;
  mesh.type = "tet4";
  for (const Vec3& x : box.nodes) mesh.nodes.push_back({x[0], x[1], x[2]});
  for (const Tetrahedron& t : box.tetrahedra) mesh.elements.push_back({t[0], t[1], t[2], t[3]});
  return mesh;
}

// The mesh of a result with all its nodes.
inline FebMesh MeshOf(const nlohmann::json& field) {
  FebMesh mesh;
  mesh.type = field.at("element_type");
  mesh.nodes = field.at("node_coordinates").get<std::vector<Point>>();
  mesh.elements = field.at("elements_0based").get<std::vector<std::vector<int>>>();
  const auto fibres = field.find("fiber_per_element");
  if (fibres != field.end() && !fibres->is_null()) mesh.fibres = fibres->get<std::vector<Point>>();
  return mesh;
}

// Corner facets of tetrahedra with all corners `inside`, with mid-edge nodes for ten-node elements.
inline std::vector<std::vector<int>> Facets(const FebMesh& mesh, const std::function<bool(const Point&)>& inside) {
  constexpr int kSides[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  constexpr int kMiddle[4][4] = {{-1, 4, 6, 7}, {4, -1, 5, 8}, {6, 5, -1, 9}, {7, 8, 9, -1}};
  std::vector<std::vector<int>> facets;
  for (const std::vector<int>& element : mesh.elements) {
    for (const auto& side : kSides) {
      std::vector<int> facet;
      bool all = true;
      for (const int c : side) {
        facet.push_back(element[c]);
        all = all && inside(mesh.nodes[static_cast<std::size_t>(element[c])]);
      }
      if (!all) continue;
      for (int c = 0; element.size() == 10 && c < 3; ++c) facet.push_back(element[kMiddle[side[c]][side[(c + 1) % 3]]]);
      facets.push_back(facet);
    }
  }
  return facets;
}

// The parts of problem d's law that FEBio provides: the fibres of its muscle material in a Mooney-Rivlin matrix.
inline std::string MuscleOf(const nlohmann::json& material) {
  const auto value = [&](const char* key) { return Text(material.at(key).get<double>()); };
  return "      <k>" + value("k") + "</k>\n      <solid type=\"Mooney-Rivlin\"><c1>" + value("c1") + "</c1><c2>" +
         value("c2") + "</c2></solid>\n      <solid type=\"muscle material\"><g1>0</g1><g2>0</g2><p1>" + value("p1") +
         "</p1><p2>" + value("p2") + "</p2><Lofl>" + value("Lofl") + "</Lofl><smax>" + value("smax") +
         "</smax><lam_max>" + value("lam_max") + "</lam_max><activation lc=\"1\">1</activation></solid>\n";
}

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_SUPPORT_FEB_WRITER_H_
