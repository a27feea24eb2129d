#include <CLI/App.hpp>
#include <nlohmann/json.hpp>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <numbers>
#include <optional>

#include "client/cli/command.h"
#include "client/cli/convert_mesh.h"
#include "client/cli/input_file.h"
#include "client/cli/interrupts.h"
#include "client/cli/mesh_picture.h"
#include "client/cli/mesh_regions.h"
#include "client/cli/stage_progress.h"
#include "client/cli/units.h"
#include "client/image/label_surface.h"
#include "client/lib/replace_file.h"
#include "core/base/stop.h"
#include "core/geometry/mesh_writer.h"
#include "core/geometry/tetrahedralize.h"
#include "core/imaging/labels.h"
#include "core/imaging/volume_reader.h"

namespace fascicle::client {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMeshExamples =
    R"(  fascicle mesh muscle.stl --out muscle.msh                   about 50,000 tetrahedra
  fascicle mesh muscle.stl --out muscle.msh --size 2.5        edges of about 2.5 at the surface, in the surface's unit
  fascicle mesh muscle.stl --out muscle.msh --region origin=near:femur.stl:3 --region insertion=near:tibia.stl:3 \
    --scene muscle.json --picture muscle.png                  attachments, a first scene, and a picture
  fascicle mesh muscle.stl --out muscle.msh --region origin=end:0,0,1:20 --region insertion=end:0,0,-1:20 \
    --scene muscle.json                                       attached over 20 length units at both ends
  fascicle mesh muscle.stl --out muscle.msh --region top=side:0,0,1:30
  fascicle mesh labels.mha --label 2 --out triceps.msh        the voxels with label 2 of a segmentation, in mm
  fascicle mesh model.inp --convert --out model.msh           a mesh of another program, with its named sets
  fascicle mesh knee.vtu --convert --split-hexahedra --out knee.msh    hexahedra, wedges and pyramids become tetrahedra

Reads .stl, .obj, .ply and .vtp. Small holes are closed; larger holes, self-intersections and surfaces around
several bodies are refused with their location. A surface inside of another is a cavity. Regions become physical tags, to which scenes refer. Ctrl-C stops the
command (exit code 4); files are written completely or not at all.
)";

struct MeshOptions {
  std::string surface;
  std::string out;
  bool convert = false;
  bool split_hexahedra = false;
  std::string unit = "mm";
  double size = 0;
  std::int64_t tetrahedra = 50000;
  double grading = MeshingOptions().grading;
  double largest_hole = -1;
  std::vector<std::string> regions;
  std::string scene;
  std::string picture;
  std::optional<int> label;
  double smoothing = 1;
  int threads = 1;
};

double Degrees(double radians) { return radians * 180 / std::numbers::pi; }

Json PlaceJson(const SurfacePlace& place) {
  return {{"centre", {place.centre.x(), place.centre.y(), place.centre.z()}}, {"extent", place.extent}};
}

double AreaOf(const TetMesh& mesh, const Region& region) { return Area({mesh.nodes, region.triangles}); }

Json ReportJson(const MeshOptions& options, const MeshingResult& result, const std::vector<Region>& regions) {
  const MeshingReport& report = result.report;
  Json holes = Json::array(), cuts = Json::array(), cavities = Json::array(), tags = Json::array();
  for (const SurfacePlace& hole : report.surface.holes) {
    holes.push_back(PlaceJson(hole));
    holes.back()["boundary_length"] = hole.length;
  }
  for (const SurfacePlace& cavity : report.surface.cavities) cavities.push_back(PlaceJson(cavity));
  for (const SurfacePlace& cut : report.surface.cuts) {
    cuts.push_back(PlaceJson(cut));
    cuts.back()["pairs"] = cut.count;
  }
  for (std::size_t i = 0; i < regions.size(); ++i) {
    tags.push_back({{"name", regions[i].name},
                    {"physical_tag", i + 1},
                    {"triangles", regions[i].triangles.size()},
                    {"area", AreaOf(result.mesh, regions[i])}});
  }
  return {{"mesh", options.out},
          {"unit", options.unit},
          {"tetrahedra", result.mesh.tetrahedra.size()},
          {"nodes", result.mesh.nodes.size()},
          {"size", report.size},
          {"smallest_dihedral_angle", Degrees(report.angles.smallest)},
          {"median_dihedral_angle", Degrees(report.angles.median)},
          {"largest_dihedral_angle", Degrees(report.angles.largest)},
          {"volume", report.volume},
          {"volume_error", report.VolumeError()},
          {"lost_volume", report.lost_volume},
          {"surface_distance", report.surface_distance},
          {"surface_distance_at", {report.furthest.x(), report.furthest.y(), report.furthest.z()}},
          {"removed_triangles", report.surface.removed_triangles},
          {"turned_triangles", report.surface.turned_triangles},
          {"welded_nodes", report.surface.welded_nodes},
          {"weld_distance", report.surface.weld_distance},
          {"closed_slits", report.surface.closed_slits},
          {"filled_holes", std::move(holes)},
          {"cuts", std::move(cuts)},
          {"cavities", std::move(cavities)},
          {"regions", std::move(tags)}};
}

// What was repaired of the surface.
void PrintRepairs(const SurfaceReport& surface, const char* unit) {
  if (surface.welded_nodes > 0) {
    std::printf("welded %lld corners with others within %.3g %s\n", static_cast<long long>(surface.welded_nodes),
                surface.weld_distance, unit);
  }
  if (surface.closed_slits > 0) {
    std::printf("closed %lld slits without width, where edges are divided differently on their two sides\n",
                static_cast<long long>(surface.closed_slits));
  }
  for (const SurfacePlace& hole : surface.holes) {
    std::printf("closed a hole at %s, with a boundary %.4g %s long\n", PlaceText(hole).c_str(), hole.length, unit);
  }
  for (const SurfacePlace& cavity : surface.cavities) {
    std::printf("a surface lies inside of another at %s: left empty, as a cavity\n", PlaceText(cavity).c_str());
  }
  for (const SurfacePlace& cut : surface.cuts) {
    std::printf("the surface intersects itself at %s (%lld pairs of triangles): meshed as one body\n",
                PlaceText(cut).c_str(), static_cast<long long>(cut.count));
  }
  if (surface.removed_triangles > 0) {
    std::printf("removed %lld triangles without area, or duplicates\n",
                static_cast<long long>(surface.removed_triangles));
  }
  if (surface.turned_triangles > 0) {
    std::printf("reoriented %lld triangles\n", static_cast<long long>(surface.turned_triangles));
  }
}

void PrintReport(const MeshOptions& options, const MeshingResult& result, const std::vector<Region>& regions) {
  const MeshingReport& report = result.report;
  const char* unit = options.unit.c_str();
  PrintRepairs(report.surface, unit);
  std::printf("tetrahedra          %zu\nnodes               %zu\nsize                %.4g %s\n",
              result.mesh.tetrahedra.size(), result.mesh.nodes.size(), report.size, unit);
  std::printf("dihedral angles     %.1f to %.1f degrees; median of the smallest %.1f\n",
              Degrees(report.angles.smallest), Degrees(report.angles.largest), Degrees(report.angles.median));
  std::printf("volume              %.6g %s^3, %+.3f %% of the surface's\n", report.volume, unit,
              100 * report.VolumeError());
  if (report.lost_volume > 0) {
    std::printf("left out            %.3g %% of the volume, in disconnected parts\n",
                100 * report.lost_volume / report.surface_volume);
  }
  std::printf("surface distance    at most %.3g %s, at (%.4g, %.4g, %.4g)\n", report.surface_distance, unit,
              report.furthest.x(), report.furthest.y(), report.furthest.z());
  if (report.surface_distance > 1.5 * report.size) {
    std::printf("                    the surface is thinner than the mesh there: a smaller --size keeps more of it\n");
  }
  for (std::size_t i = 0; i < regions.size(); ++i) {
    std::printf("region %-12s physical tag %zu: %zu triangles, %.4g %s^2\n", regions[i].name.c_str(), i + 1,
                regions[i].triangles.size(), AreaOf(result.mesh, regions[i]), unit);
  }
  for (const std::string& file : {options.out, options.scene, options.picture}) {
    if (!file.empty()) std::cout << "written to " << file << '\n';
  }
}

Vec3 MeanNode(const TetMesh& mesh, const Region& region) {
  Vec3 sum = Vec3::Zero();
  for (const std::int32_t n : region.nodes) sum += mesh.nodes[static_cast<std::size_t>(n)];
  return sum / static_cast<double>(region.nodes.size());
}

// The tendon at an attachment, as a region of a scene: what lies beyond a plane across the muscle, a little inside of
// the attachment, but not more than 15 % of the muscle's length; at least a layer of tetrahedra. Without it, fibres
// would end at a rigid support. `size` is the edge length of the mesh.
Json TendonRegion(const TetMesh& mesh, double size, const Region& end, const Region& other_end) {
  constexpr double kMost = 0.15, kBeyond = 0.03, kLayer = 1.5;  // of the length; of the size
  const Vec3 outwards = (MeanNode(mesh, end) - MeanNode(mesh, other_end)).normalized();
  double lowest = INFINITY, highest = -INFINITY, innermost = INFINITY;
  for (const Vec3& node : mesh.nodes) {
    lowest = std::min(lowest, outwards.dot(node));
    highest = std::max(highest, outwards.dot(node));
  }
  for (const std::int32_t n : end.nodes) {
    innermost = std::min(innermost, outwards.dot(mesh.nodes[static_cast<std::size_t>(n)]));
  }
  const double length = highest - lowest;
  const double place = std::max(innermost - std::max(kBeyond * length, kLayer * size),
                                highest - std::max(kMost * length, kLayer * size));
  const Vec3 middle = MeanNode(mesh, end);
  const Vec3 point = middle + (place - outwards.dot(middle)) * outwards;
  const auto list = [](const Vec3& x) { return Json::array({x[0], x[1], x[2]}); };
  return {{"name", end.name + "_tendon"}, {"plane", {{"point", list(point)}, {"normal", list(outwards)}}}};
}

// A scene with a muscle between its first two regions, with tendon at both, in equilibrium at increasing activation.
Json SceneJson(const MeshOptions& options, const MeshingResult& result, const std::vector<Region>& regions) {
  Json list = Json::array(), constraints = Json::array();
  for (std::size_t i = 0; i < regions.size(); ++i) {
    list.push_back({{"name", regions[i].name}, {"physical_tag", i + 1}});
    if (i < 2) constraints.push_back({{"region", regions[i].name}});
  }
  Json tendons = Json::array();
  for (std::size_t i = 0; i < 2; ++i) {
    list.push_back(TendonRegion(result.mesh, result.report.size, regions[i], regions[1 - i]));
    tendons.push_back({{"region", list.back()["name"]}, {"material", {{"tendon", Json::object()}}}});
  }
  const fs::path folder = fs::absolute(options.scene).parent_path();
  const std::string name = fs::path(options.out).stem().string();
  Json body = {{"name", "muscle"},
               {"unit", options.unit},
               {"mesh", {{"file", {{"path", fs::absolute(options.out).lexically_relative(folder).string()}}}}},
               {"material", {{"muscle", {{"optimal_stretch", 1}}}}},
               {"region_materials", std::move(tendons)},
               {"regions", std::move(list)},
               {"fibres", {{"harmonic", {{"origin", regions[0].name}, {"insertion", regions[1].name}}}}},
               {"constraints", std::move(constraints)},
               {"activation", {{"times", {0, 1}}, {"values", {0, 0.3}}}}};
  return {{"name", name},
          {"bodies", Json::array({std::move(body)})},
          {"duration", 1},
          {"output", {{"frame_interval", 0.5}, {"fields", {"fibre_stretch", "volume_ratio"}}}},
          {"tet", {{"stepping", "quasi_static"}}}};
}

// Reports the problems of a file or the command line as one error.
void FailOn(const Problems& problems, const std::string& file) {
  if (problems.empty()) return;
  Error error{Error::Kind::kInvalid, "the surface " + file + " can't be meshed", "INVALID_SURFACE", {}};
  for (const Problem& problem : problems.kept()) {
    error.problems.Add(problem.path.empty() ? file : problem.path, problem.message, problem.hint);
  }
  throw CommandError(std::move(error));
}

struct Input {
  TriangleMesh surface;
  std::optional<double> voxel_volume;  // of a label image
  std::vector<std::string> notes;      // on flaws of the file, and what its reader decided
};

// The longest edge of the box around a surface.
double LengthOf(const TriangleMesh& surface) {
  Eigen::AlignedBox3d box;
  for (const Vec3& node : surface.nodes) box.extend(node);
  return box.sizes().maxCoeff();
}

// A label's surface in the unit of the command.
void TakeLabel(LabelSurface label, const MeshOptions& options, Input& input) {
  const double scale = MetresIn("mm") / MetresIn(options.unit);
  input.surface = std::move(label.surface);
  for (Vec3& node : input.surface.nodes) node *= scale;
  input.voxel_volume = label.voxel_volume * std::pow(scale, 3);
  input.notes = std::move(label.notes);
  const std::string note = NoteOnSize(LengthOf(input.surface) * MetresIn(options.unit));
  if (!note.empty()) input.notes.push_back(note);
}

Input ReadInput(const MeshOptions& options, const std::stop_token& stop, Problems& problems) {
  Input input;
  const bool is_image = IsImagePath(options.surface);
  if (is_image && !options.label) {
    problems.Add("--label", "is required for an image", "give the label of the body");
  }
  if (!is_image && options.label) {
    problems.Add("--label", options.surface + " is not a label image",
                 "an image is a DICOM folder, or ends in " + KnownVolumeExtensions());
  }
  if (!is_image) {
    const std::optional<std::string> bytes = ReadInputFile(options.surface, problems);
    if (!bytes) return input;
    auto surface = ReadSurface(options.surface, *bytes, problems, stop, &input.notes);
    if (surface) input.surface = std::move(*surface);
  } else if (options.label) {
    auto label = ReadLabelSurface(options.surface, *options.label, options.smoothing, stop, problems);
    if (label) TakeLabel(std::move(*label), options, input);
  }
  return input;
}

void CheckOutName(const MeshOptions& options, Problems& problems) {
  if (fs::path(options.out).extension() == ".msh") return;
  problems.Add("--out", "expects a file that ends in .msh", "the mesh is written in Gmsh's format");
}

int MakeMesh(const MeshOptions& options, const Context& context) {
  const StopOnInterrupt interrupts;
  const std::stop_token stop = interrupts.token();
  Problems problems;
  if (options.convert) {
    CheckOutName(options, problems);
    FailOn(problems, options.surface);
    ConvertMesh({options.surface, options.out, options.unit, options.split_hexahedra}, context, stop);
    return kDone;
  }
  Input input = ReadInput(options, stop, problems);
  const std::vector<RegionRequest> requests = ReadRegionRequests(options.regions, stop, problems);
  CheckOutName(options, problems);
  if (!options.scene.empty() && requests.size() < 2) {
    problems.Add("--scene", "a muscle needs two attachments", "give --region twice: the origin, then the insertion");
  }
  for (const RegionRequest& request : requests) {
    const bool is_tendon =
        !options.scene.empty() && requests.size() >= 2 &&
        (request.name == requests[0].name + "_tendon" || request.name == requests[1].name + "_tendon");
    if (is_tendon) {
      problems.Add("--region " + request.name, "has the name of a tendon of the scene", "give it another name");
    }
  }
  FailOn(problems, options.surface);

  ThreadTeam team(options.threads, stop);
  MeshingOptions meshing;
  meshing.size = options.size;
  meshing.tetrahedra = options.tetrahedra;
  meshing.grading = options.grading;
  meshing.largest_hole = options.largest_hole;
  std::optional<MeshingResult> result;
  {
    StageProgress bar;
    result = Tetrahedralize(input.surface, meshing, team, problems,
                            [&](double part, const char* stage) { bar.Show(part, stage); });
  }
  FailOn(problems, options.surface);
  const std::vector<Region> regions = MarkRegions(requests, stop, result->mesh, problems);
  if (!options.scene.empty() && problems.empty()) CheckEnds(regions[0], regions[1], problems);
  FailOn(problems, options.surface);

  std::vector<TagName> names;
  for (const Region& region : regions) names.push_back({2, static_cast<std::int32_t>(names.size() + 1), region.name});
  names.push_back({3, static_cast<std::int32_t>(names.size() + 1), "body"});
  ReplaceFile(options.out, GmshText(result->mesh, names, stop));
  if (!options.scene.empty()) ReplaceFile(options.scene, SceneJson(options, *result, regions).dump(2) + "\n");
  ThrowIfStopped(stop);
  if (!options.picture.empty()) {
    DrawMesh(result->mesh, regions, MetresIn(options.unit), fs::path(options.out).stem().string(), options.picture);
  }
  if (context.json) {
    Json report = ReportJson(options, *result, regions);
    report["notes"] = input.notes;
    if (input.voxel_volume) report["voxel_volume"] = *input.voxel_volume;
    PrintJson(report);
  } else {
    for (const std::string& note : input.notes) std::printf("note  %s\n", note.c_str());
    if (input.voxel_volume) {
      std::printf("label %d: smoothing changed its volume by %+.3f %%\n", *options.label,
                  100 * (result->report.surface_volume / *input.voxel_volume - 1));
    }
    PrintReport(options, *result, regions);
  }
  return kDone;
}

}  // namespace

void AddMesh(CLI::App& app, Context& context) {
  CLI::App* command =
      AddCommand(app, "mesh", "Fill a closed surface with tetrahedra, or convert a mesh", kMeshExamples);
  const auto options = std::make_shared<MeshOptions>();
  command
      ->add_option(
          "SURFACE", options->surface,
          "The surface: .stl, .obj, .ply or .vtp; or a label image: .mha, .mhd, .nrrd, .nhdr, .nii, .nii.gz, .hdr, "
          "or the folder of a DICOM series. Images lie in patient coordinates: x left, y back, z head")
      ->required();
  command->add_option("--out", options->out, "The mesh file")->required()->type_name("FILE.msh");
  CLI::Option* convert =
      command->add_flag("--convert", options->convert,
                        "Convert a volume mesh instead: " + ConvertibleExtensions() + "; named sets become regions");
  command
      ->add_flag("--split-hexahedra", options->split_hexahedra,
                 "With --convert: split hexahedra, wedges and pyramids into tetrahedra")
      ->needs(convert);
  command->add_option("--unit", options->unit, "Unit of the surface and of all lengths given here")
      ->check(CLI::IsMember({"m", "cm", "mm"}));
  CLI::Option* size = command->add_option("--size", options->size, "Edge length at the surface")
                          ->check(CLI::PositiveNumber)
                          ->type_name("LENGTH");
  command->add_option("--tets", options->tetrahedra, "Approximate number of tetrahedra, without --size; 50000")
      ->check(CLI::Range(std::int64_t{100}, std::int64_t{20'000'000}))
      ->excludes(size);
  command
      ->add_option("--grading", options->grading,
                   "Growth of the edge length per unit of distance from the surface; 0: uniform")
      ->check(CLI::Range(0.0, 2.0));
  command
      ->add_option("--max-hole", options->largest_hole,
                   "Size of the largest holes to fill; a tenth of the surface's size")
      ->check(CLI::NonNegativeNumber)
      ->type_name("LENGTH");
  command
      ->add_option(
          "--region", options->regions,
          "Name a part of the mesh's surface: its end along a direction, its side facing a direction, or its part near "
          "another surface; may be repeated")
      ->type_name("NAME=end:X,Y,Z:LENGTH|NAME=side:X,Y,Z[:DEGREES]|NAME=near:SURFACE:DISTANCE")
      ->allow_extra_args(false);
  command
      ->add_option("--scene", options->scene,
                   "Write a scene with a muscle between the first two regions, and tendon at both")
      ->type_name("FILE.json");
  command->add_option("--picture", options->picture, "Draw the mesh, coloured by its regions")->type_name("FILE.png");
  command->add_option("--label", options->label, "For an image: the label of the body");
  command
      ->add_option("--smooth", options->smoothing,
                   "For an image: standard deviation of the Gaussian that smooths the voxel staircase [voxel]")
      ->check(CLI::Range(0.3, 10.0));
  command->add_option("--threads", options->threads, "Number of threads; the mesh does not depend on it")
      ->check(CLI::Range(1, 256));
  for (const char* name :
       {"--size", "--tets", "--grading", "--max-hole", "--region", "--scene", "--picture", "--label", "--smooth"}) {
    convert->excludes(command->get_option(name));
  }
  command->callback(
      [options, &context] { context.action = [options, &context] { return MakeMesh(*options, context); }; });
}

}  // namespace fascicle::client
