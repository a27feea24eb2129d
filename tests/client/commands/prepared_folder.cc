#include "prepared_folder.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "tests/support/files.h"
#include "tests/support/sample_models.h"
#include "tests/support/sample_osim.h"
#include "tests/support/volume_files.h"

namespace fascicle::testing {
namespace {

using Point = std::array<double, 3>;

// An ellipsoid as a closed surface of triangles, in the STL format.
std::string EllipsoidStl(const Point& centre, const Point& radii) {
  constexpr int kAround = 24, kAlong = 24;
  const auto at = [&](int i, int k) -> Point {
    const double polar = std::numbers::pi * k / kAlong, angle = 2 * std::numbers::pi * (i % kAround) / kAround;
    const double ring = k == 0 || k == kAlong ? 0 : std::sin(polar);
    return {centre[0] + radii[0] * ring * std::cos(angle), centre[1] + radii[1] * ring * std::sin(angle),
            centre[2] + radii[2] * std::cos(polar)};
  };
  std::string text = "solid ellipsoid\n";
  const auto add = [&](const Point& a, const Point& b, const Point& c) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const Point& p : {a, b, c}) {
      char line[128];
      std::snprintf(line, sizeof line, "vertex %.9g %.9g %.9g\n", p[0], p[1], p[2]);
      text += line;
    }
    text += "endloop\nendfacet\n";
  };
  for (int k = 0; k < kAlong; ++k) {
    for (int i = 0; i < kAround; ++i) {
      if (k > 0) add(at(i, k), at(i, k + 1), at(i + 1, k));
      if (k + 1 < kAlong) add(at(i + 1, k), at(i, k + 1), at(i + 1, k + 1));
    }
  }
  return text + "endsolid ellipsoid\n";
}

// Two bellies side by side, labels 1 and 2, in voxels of 1 mm.
std::string LabelImage() {
  constexpr int kSize[3] = {48, 40, 60};
  std::string voxels;
  for (int k = 0; k < kSize[2]; ++k) {
    for (int j = 0; j < kSize[1]; ++j) {
      for (int i = 0; i < kSize[0]; ++i) {
        const auto inside = [&](double x) {
          return std::pow((i - x) / 9, 2) + std::pow((j - 20) / 9.0, 2) + std::pow((k - 30) / 24.0, 2) < 1;
        };
        voxels += static_cast<char>(inside(14) ? 1 : inside(34) ? 2 : 0);
      }
    }
  }
  return "ObjectType = Image\nNDims = 3\nBinaryData = True\nElementSpacing = 1 1 1\nDimSize = 48 40 60\n"
         "ElementType = MET_UCHAR\nElementDataFile = LOCAL\n" +
         voxels;
}

// A bright belly in darker tissue, as bare numbers of 16 bits.
std::string RawScan() {
  constexpr int kSize[3] = {140, 220, 71};
  std::string voxels;
  for (int k = 0; k < kSize[2]; ++k) {
    for (int j = 0; j < kSize[1]; ++j) {
      for (int i = 0; i < kSize[0]; ++i) {
        const double outside =
            std::pow((i - 70) / 40.0, 2) + std::pow((j - 110) / 60.0, 2) + std::pow((k - 35) / 30.0, 2);
        const int value = outside < 1 ? 700 : outside < 2 ? 300 : 20;
        voxels += Number(static_cast<std::int16_t>(value + (i + 3 * j + 5 * k) % 7));
      }
    }
  }
  return voxels;
}

// A bright ball of bone in soft tissue.
void WriteDicomSeries(const std::filesystem::path& folder) {
  constexpr int kSide = 16, kSlices = 8;
  std::filesystem::create_directories(folder);
  for (int k = 0; k < kSlices; ++k) {
    DicomSlice slice;
    slice.rows = slice.columns = kSide;
    slice.spacing = "1\\1";
    slice.thickness = "2";
    slice.position = "0\\0\\" + std::to_string(2 * k);
    slice.first_value = 1000 * k;
    for (int j = 0; j < kSide; ++j) {
      for (int i = 0; i < kSide; ++i) {
        const double distance = std::hypot(i - 7.5, j - 7.5, 2 * (k - 3.5));
        slice.voxels.push_back(distance < 5 ? 400 : 50);
      }
    }
    WriteFile(folder / ("slice" + std::to_string(k) + ".dcm"), DicomBytes(slice));
  }
}

// A bar of two hexahedra, in mm.
constexpr const char* kAbaqusHexahedra = R"(*HEADING
a bar
*NODE
1, 0, 0, 0
2, 10, 0, 0
3, 10, 10, 0
4, 0, 10, 0
5, 0, 0, 10
6, 10, 0, 10
7, 10, 10, 10
8, 0, 10, 10
9, 0, 0, 20
10, 10, 0, 20
11, 10, 10, 20
12, 0, 10, 20
*ELEMENT, TYPE=C3D8, ELSET=bar
1, 1, 2, 3, 4, 5, 6, 7, 8
2, 5, 6, 7, 8, 9, 10, 11, 12
*NSET, NSET=bottom
1, 2, 3, 4
*NSET, NSET=top
9, 10, 11, 12
)";

constexpr const char* kAbaqusTetrahedra = R"(*NODE
1, 0, 0, 0
2, 10, 0, 0
3, 0, 10, 0
4, 0, 0, 10
5, 10, 10, 10
*ELEMENT, TYPE=C3D4, ELSET=muscle
1, 1, 2, 3, 4
2, 2, 3, 4, 5
*NSET, NSET=bottom
1, 2, 3
)";

constexpr const char* kVtkHexahedron = R"(<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian">
  <UnstructuredGrid>
    <Piece NumberOfPoints="8" NumberOfCells="1">
      <Points>
        <DataArray type="Float64" NumberOfComponents="3" format="ascii">
          0 0 0  1 0 0  1 1 0  0 1 0  0 0 1  1 0 1  1 1 1  0 1 1
        </DataArray>
      </Points>
      <Cells>
        <DataArray type="Int64" Name="connectivity" format="ascii">0 1 2 3 4 5 6 7</DataArray>
        <DataArray type="Int64" Name="offsets" format="ascii">8</DataArray>
        <DataArray type="UInt8" Name="types" format="ascii">12</DataArray>
      </Cells>
    </Piece>
  </UnstructuredGrid>
</VTKFile>
)";

// A block of one hexahedron, stretched.
constexpr const char* kFebioHexahedron = R"(<febio_spec version="4.0">
  <Module type="solid"/>
  <Control><analysis>STATIC</analysis><time_steps>2</time_steps><step_size>0.5</step_size></Control>
  <Material>
    <material id="1" name="soft" type="neo-Hookean"><density>1e-9</density><E>0.1</E><v>0.3</v></material>
  </Material>
  <Mesh>
    <Nodes name="all">
      <node id="1">0,0,0</node><node id="2">10,0,0</node><node id="3">10,10,0</node><node id="4">0,10,0</node>
      <node id="5">0,0,10</node><node id="6">10,0,10</node><node id="7">10,10,10</node><node id="8">0,10,10</node>
    </Nodes>
    <Elements type="hex8" name="block"><elem id="1">1,2,3,4,5,6,7,8</elem></Elements>
    <NodeSet name="bottom">1,2,3,4</NodeSet>
    <NodeSet name="top">5,6,7,8</NodeSet>
  </Mesh>
  <MeshDomains><SolidDomain name="block" mat="soft"/></MeshDomains>
  <Boundary>
    <bc type="zero displacement" node_set="bottom"><x_dof>1</x_dof><y_dof>1</y_dof><z_dof>1</z_dof></bc>
    <bc type="prescribed displacement" node_set="top"><dof>z</dof><value lc="1">1.0</value></bc>
  </Boundary>
  <LoadData>
    <load_controller id="1" type="loadcurve"><interpolate>LINEAR</interpolate>
      <points><pt>0,0</pt><pt>1,1</pt></points></load_controller>
  </LoadData>
</febio_spec>
)";

// Tetrahedra with a contact, which a scene lacks.
std::string FebioWithContact() {
  std::string model = kSmallModel;
  model.insert(model.find("  <LoadData>"), "  <Contact><contact type=\"sliding-elastic\"/></Contact>\n");
  return model;
}

// A coarse spindle between supports that has the names of all lines: regions, probes and fields.
constexpr const char* kMuscleScene = R"({
  "name": "muscle",
  "bodies": [{
    "name": "muscle",
    "unit": "mm",
    "mesh": {"fusiform": {"length": 120, "belly_radius": 15, "end_radius": 6,
                          "divisions_across": 2, "divisions_along": 6}},
    "material": {"muscle": {"bulk_modulus": 1e6}},
    "regions": [
      {"name": "end", "plane": {"point": [0, 0, 0], "normal": [0, 0, -1]}},
      {"name": "belly", "box": {"min": [-20, -20, 39], "max": [20, 20, 81]}},
      {"name": "insertion", "plane": {"point": [0, 0, 120], "normal": [0, 0, 1]}}
    ],
    "fibres": {"harmonic": {"origin": "end", "insertion": "insertion"}},
    "constraints": [{"region": "end"}, {"region": "insertion"}],
    "activation": {"times": [0, 0.2], "values": [0, 1], "interpolation": "smooth"}
  }],
  "duration": 0.2,
  "output": {"frame_interval": 0.01,
             "fields": ["fibre_stretch", "volume_ratio", "cauchy_stress", "principal_strains"],
             "probes": [{"name": "end", "body": "muscle", "point": [0, 0, 20]},
                        {"name": "insertion", "body": "muscle", "point": [0, 0, 100]}]},
  "tet": {"stepping": "quasi_static"}
})";

// A swinging block of rubber, in steps of 0.1 ms.
std::string BlockScene(double duration, double interval) {
  return R"({"name": "block", "bodies": [{"name": "block", "unit": "cm",
    "mesh": {"box": {"size": [1, 1, 1], "divisions": [2, 2, 2]}},
    "material": {"neo_hookean": {"young_modulus": 1e4}},
    "regions": [{"name": "floor", "plane": {"point": [0, 0, 0], "normal": [0, 0, -1]}}],
    "constraints": [{"region": "floor"}]}],
    "gravity": {"acceleration": [0, 0, -9.81]},
    "duration": )" +
         std::to_string(duration) + R"(, "output": {"frame_interval": )" + std::to_string(interval) +
         R"(}, "tet": {"time_step": 1e-4}})";
}

}  // namespace

void WriteInputs(const std::filesystem::path& folder) {
  const auto write = [&](const char* name, const std::string& bytes) {
    std::filesystem::create_directories((folder / name).parent_path());
    WriteFile(folder / name, bytes);
  };
  write("scene.json", kMuscleScene);
  write("invalid.json", R"({"duraton": 1})");
  // A belly along z, and bones that touch it above and below [mm].
  const std::string belly = EllipsoidStl({0, 0, 60}, {15, 15, 60});
  for (const char* name : {"muscle.stl", "biceps.stl", "vh_muscle_surfaces/NAME.stl"}) write(name, belly);
  for (const char* name : {"scapula.stl", "femur.stl"}) write(name, EllipsoidStl({0, 0, 125}, {30, 30, 10}));
  for (const char* name : {"radius.stl", "tibia.stl"}) write(name, EllipsoidStl({0, 0, -5}, {30, 30, 10}));
  write("labels.mha", LabelImage());
  write("scan.raw", RawScan());
  WriteDicomSeries(folder / "ct");
  write("knee.inp", kAbaqusHexahedra);
  write("model.inp", kAbaqusTetrahedra);
  write("knee.vtu", kVtkHexahedron);
  for (const char* name : {"model.feb", "biceps.feb"}) write(name, kSmallModel);
  write("knee.feb", kFebioHexahedron);
  for (const char* name : {"arm.osim", "arm26.osim"}) write(name, kSmallOsim);
  write("flexion.mot", kSmallMotion);
  write("upper.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
  write("ankle.feb", FebioWithContact());
  write("test.csv", "stretch,stress [Pa]\n1,0\n1.1,6200\n1.2,11500\n1.4,21000\n1.6,30500\n1.8,41500\n");
  write("rubber.csv", "stretch,stress [Pa]\n1,0\n1.1,27000\n1.3,66000\n1.6,105000\n2,142000\n");
  write("electrodes.csv", "x,y,z\n0,0,0.04\n0,0,0.06\n0.005,0,0.06\n");
  // Folders of a user's home that the lines of `completion` write to.
  std::filesystem::create_directories(folder / "home/.local/share/bash-completion/completions");
  std::filesystem::create_directories(folder / "home/.config/fish/completions");
}

std::string QuickScene() { return BlockScene(0.001, 0.0005); }
std::string EndlessScene() { return BlockScene(1000, 1); }

std::string SteeredScene() {
  return R"({"name": "steered", "bodies": [{"name": "muscle", "unit": "cm",
    "mesh": {"box": {"size": [2, 2, 4], "divisions": [2, 2, 4]}},
    "material": {"muscle": {"bulk_modulus": 1e5}}, "fibres": {"constant": {"direction": [0, 0, 1]}},
    "regions": [{"name": "origin", "plane": {"point": [0, 0, 0], "normal": [0, 0, -1]}},
                {"name": "insertion", "plane": {"point": [0, 0, 4], "normal": [0, 0, 1]}},
                {"name": "tip", "side": {"direction": [1, 0, 0]}}],
    "constraints": [{"region": "origin"}, {"region": "insertion", "motion": {"translation": [{"axis": "x",
                     "curve": {"times": [0, 100], "values": [0.0001, 0.001]}}]}}],
    "loads": [{"region": "tip", "traction": {"vector": [10, 0, 0]}}], "damping": {"mass_proportional": 20}}],
    "gravity": {"acceleration": [0, 0, -9.81]}, "duration": 800, "output": {"frame_interval": 0.01}, "tet": {}})";
}

}  // namespace fascicle::testing
