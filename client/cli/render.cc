#include <algorithm>
#include <charconv>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>

#include "client/cli/command.h"
#include "client/cli/follow.h"
#include "client/cli/image_options.h"
#include "client/cli/job_source.h"
#include "client/cli/outputs.h"
#include "client/cli/stage_progress.h"
#include "client/lib/decode.h"
#include "client/render/body_labels.h"
#include "client/render/slices.h"
#include "core/base/letters.h"
#include "core/imaging/volume_reader.h"

namespace fascicle::client {
namespace {

constexpr const char* kRenderExamples =
    R"(  fascicle render 3f2a --out last.png                             the last frame, coloured by displacement
  fascicle render out --out last.png                              that of the run that wrote the folder out
  fascicle render 3f2a --out f7.png --frame 7 --colour cauchy_stress/zz --wireframe
  fascicle render 3f2a --out fibres.png --fibres --view front --size 900x1200
  fascicle render 3f2a --out a.png --colour volume_ratio --range 0.98 1.02 --azimuth 30 --elevation 15

  fascicle render 3f2a --out all.png --frames all                 panels side by side, with a common colour scale
  fascicle render 3f2a --out series.png --frames 0,2,4 --style volume
  fascicle render 3f2a --out release.gif --frames all --fps 12    an animated GIF
  fascicle render 3f2a --out cut.png --style slices --scan arm.mha
  fascicle render 3f2a --out round.gif --turntable 48 --smooth    the view rotates around the last frame
  fascicle render 3f2a --out upright.png --up z --view front      upright; `--up y` for bodies whose height is y

Styles: surface (shaded; --wireframe adds the edges, --smooth smooths voxel steps), wireframe (edges only),
volume (rays cast through the body), slices (the outline of the deformed bodies on slices of the scan). Bodies of the
eulerian method are surfaces: only the styles surface and wireframe apply, without --fibres.
Needs no display: without one it uses a virtual display (Xvfb).
)";

struct RenderOptions {
  std::string job;
  std::string out;
  std::string frame = "last";
  std::string frames;
  std::string style = "surface";
  std::vector<std::string> scan;
  std::vector<double> window;
  std::optional<double> crop;
  int turntable = 0;
  double fps = 12;
  bool smooth = false;
  std::optional<std::string> colour;
  std::vector<double> range;
  bool wireframe = false;
  bool no_surface = false;
  bool no_rest = false;
  bool fibres = false;
  bool no_rigid_bodies = false;
  bool no_lines = false;
  std::string view = "auto";
  std::optional<double> azimuth, elevation;
  std::string up;
  double zoom = 1;
  std::string size = "1200x900";
  std::optional<std::string> title;
};

bool IsGif(const RenderOptions& options) { return LowerExtension(options.out) == ".gif"; }

struct Angles {
  double azimuth, elevation;
};

const std::map<std::string, Angles>& Views() {
  static const std::map<std::string, Angles> views = {{"front", {-90, 0}},  {"back", {90, 0}},  {"left", {180, 0}},
                                                      {"right", {0, 0}},    {"top", {-90, 90}}, {"bottom", {-90, -90}},
                                                      {"corner", {-60, 20}}};
  return views;
}

// The vertical of --up.
const std::map<std::string, Vec3>& Verticals() {
  static const std::map<std::string, Vec3> verticals = {{"x", Vec3::UnitX()},   {"y", Vec3::UnitY()},
                                                        {"z", Vec3::UnitZ()},   {"-x", -Vec3::UnitX()},
                                                        {"-y", -Vec3::UnitY()}, {"-z", -Vec3::UnitZ()}};
  return verticals;
}

PictureSize ParseSize(const std::string& text) {
  PictureSize size{0, 0};
  const char* end = text.data() + text.size();
  const auto [cross, error] = std::from_chars(text.data(), end, size.width);
  const bool good = error == std::errc() && cross != end && *cross == 'x' &&
                    std::from_chars(cross + 1, end, size.height).ptr == end && size.width >= 16 && size.height >= 16 &&
                    size.width <= 8192 && size.height <= 8192;
  if (!good) throw CommandError::Invalid("--size: expects WIDTHxHEIGHT of 16 to 8192 pixels, such as 1200x900");
  return size;
}

std::int64_t FrameIndex(const std::string& text, const v1::Job& job) {
  if (text == "last") return job.frame_count() - 1;
  std::int64_t index = -1;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, index);
  if (error != std::errc() || stop != end || index < 0 || index >= job.frame_count()) {
    throw CommandError::Invalid("--frame: expects `last` or a number from 0 to " +
                                std::to_string(job.frame_count() - 1));
  }
  return index;
}

// "all", or numbers separated by commas. Any number for a GIF.
std::vector<std::int64_t> FrameIndices(const RenderOptions& options, const v1::Job& job) {
  if (options.frames.empty()) return {FrameIndex(options.frame, job)};
  std::vector<std::int64_t> indices;
  if (options.frames == "all") {
    for (std::int64_t i = 0; i < job.frame_count(); ++i) indices.push_back(i);
  } else {
    std::istringstream list(options.frames);
    for (std::string item; std::getline(list, item, ',');) indices.push_back(FrameIndex(item, job));
  }
  constexpr std::size_t kMostPanels = 24;
  if (!IsGif(options) && indices.size() > kMostPanels) {
    throw CommandError::Invalid("--frames: " + std::to_string(indices.size()) +
                                " panels are too many for one picture; at most 24, or write a .gif");
  }
  return indices;
}

PictureOptions PictureOf(const RenderOptions& options, const v1::Job& job, const v1::Frame& frame) {
  PictureOptions picture = DefaultPicture(job, frame);
  picture.size = ParseSize(options.size);
  if (options.colour) picture.colour = *options.colour == "none" ? "" : *options.colour;
  if (!options.range.empty()) picture.range = {options.range[0], options.range[1]};
  picture.surface = !options.no_surface && options.style == "surface";
  picture.wireframe = options.wireframe || options.style == "wireframe";
  picture.volume = options.style == "volume";
  picture.smooth = options.smooth;
  picture.rest_outline = !options.no_rest;
  picture.fibres = options.fibres;
  picture.rigid_bodies = !options.no_rigid_bodies;
  picture.lines = !options.no_lines;
  picture.zoom = options.zoom;
  if (const auto view = Views().find(options.view); view != Views().end()) {
    picture.azimuth = view->second.azimuth;
    picture.elevation = view->second.elevation;
  }
  if (const auto up = Verticals().find(options.up); up != Verticals().end()) picture.up = up->second;
  if (options.azimuth) picture.azimuth = options.azimuth;
  if (options.elevation) picture.elevation = options.elevation;
  if (options.title) picture.title = *options.title;
  return picture;
}

// Bodies of the eulerian method are surfaces without an interior.
void CheckCanBeSeen(const RenderOptions& options, const v1::Geometry& geometry) {
  const bool inside = options.style == "volume" || options.style == "slices";
  if (!inside && !options.fibres) return;
  for (const v1::BodyGeometry& body : geometry.bodies()) {
    if (body.triangles().empty()) continue;
    throw CommandError::Invalid((inside ? "--style " + options.style : std::string("--fibres")) + ": the body `" +
                                body.name() +
                                "` is a surface, without elements inside; use the style surface or "
                                "wireframe, and --colour for fields of fibres");
  }
}

// Draws the scan with the outline of a frame's bodies.
void DrawOnScan(const RenderOptions& options, const v1::Geometry& geometry, const v1::Frame& frame,
                const PictureOptions& picture) {
  Problems problems;
  const std::vector<std::filesystem::path> paths(options.scan.begin(), options.scan.end());
  const auto scan = ReadVolumeFiles(paths, {}, problems);
  if (!scan) {
    Error error{Error::Kind::kInvalid, "the scan can't be read", "INVALID_IMAGE", {}};
    for (const Problem& problem : problems.kept()) error.problems.Add("--scan", problem.message, problem.hint);
    throw CommandError(std::move(error));
  }
  for (const std::string& note : scan->notes) std::cerr << "note  " << note << '\n';
  const ImagePlace place = {scan->size, scan->spacing, scan->origin, scan->direction};
  std::vector<std::uint8_t> labels(scan->voxels());
  SlicesInput input;
  const std::vector<BodyShape> shapes = DecodeGeometry(geometry);
  for (std::size_t b = 0; b < shapes.size() && b < 255; ++b) {
    const auto positions = DecodePositions(frame.bodies(static_cast<int>(b)), shapes[b].positions.size());
    AddLabels(shapes[b], positions, place, static_cast<std::uint8_t>(b + 1), labels);
    input.names.push_back(shapes[b].name);
  }
  if (std::all_of(labels.begin(), labels.end(), [](std::uint8_t label) { return label == 0; })) {
    throw CommandError::Invalid("--scan: no body is inside of the image; it must be the image of the scene");
  }
  input.size = scan->size;
  input.spacing = scan->spacing;
  input.direction = scan->direction;
  SetSliceOptions(options.window, options.crop, input);
  input.values = scan->values;
  input.labels = labels;
  input.title = picture.title;
  DrawSlices(input, picture.size, options.out);
}

int Render(const RenderOptions& options, const Context& context) {
  if ((options.style == "slices") != !options.scan.empty()) {
    throw CommandError::Invalid("--style slices and --scan must be used together: the outline is drawn on the scan");
  }
  if (options.style != "slices" && (!options.window.empty() || options.crop)) {
    throw CommandError::Invalid("--window and --crop need --style slices");
  }
  (void)ParseSize(options.size);
  if (!IsGif(options) && LowerExtension(options.out) != ".png") {
    throw CommandError::Invalid(
        "--out: pictures are written as PNG, animations as GIF: the name must end in .png or .gif");
  }
  if (options.turntable > 0 && !IsGif(options)) {
    throw CommandError::Invalid("--turntable: needs an animated GIF: --out must end in .gif");
  }
  JobSource source = OpenJob(context, options.job);
  const std::string& name = source.job;
  const v1::Job job = Take(source.client.GetJob(name));
  if (job.frame_count() == 0) throw CommandError::Invalid(name + " has no frames yet");
  const std::vector<std::int64_t> indices = FrameIndices(options, job);
  std::vector<v1::Frame> frames;
  v1::Geometry geometry;
  for (const std::int64_t index : indices) {
    const Followed followed =
        ReadStored(source.client, name, FramesFrom(index), [](const v1::Geometry&, const v1::Frame&) { return false; });
    if (!followed.last_frame) throw std::runtime_error("the server did not send frame " + std::to_string(index));
    geometry = followed.geometry;
    frames.push_back(*followed.last_frame);
  }
  CheckCanBeSeen(options, geometry);
  const PictureOptions picture = PictureOf(options, job, frames.back());
  if (options.style == "slices") {
    DrawOnScan(options, geometry, frames.back(), picture);
  } else if (IsGif(options)) {
    StageProgress bar;
    DrawAnimation(geometry, frames, picture, {options.fps, options.turntable}, options.out,
                  [&](double part) { bar.Show(part, "drawing"); });
  } else {
    DrawPanels(geometry, frames, picture, options.out);
  }
  if (context.json) {
    nlohmann::json drawn = nlohmann::json::array();
    for (const v1::Frame& frame : frames) drawn.push_back({{"frame", frame.index()}, {"time", frame.time()}});
    PrintJson({{"job", name},
               {"frame", frames.back().index()},
               {"time", frames.back().time()},
               {"frames", std::move(drawn)},
               {"out", options.out}});
  } else if (frames.size() == 1) {
    std::cout << "frame " << frames[0].index() << " is in " << options.out << '\n';
  } else {
    std::cout << frames.size() << " frames are in " << options.out << '\n';
  }
  return kDone;
}

}  // namespace

void AddRender(CLI::App& app, Context& context) {
  CLI::App* command = AddCommand(app, "render", "Draw frames of a job as PNG, or animate them as GIF", kRenderExamples);
  const auto options = std::make_shared<RenderOptions>();
  command->add_option("JOB", options->job, "The job")->required();
  command->add_option("--out", options->out, "The picture, or animation")->required()->type_name("FILE.png|FILE.gif");
  const auto frame = command->add_option("--frame", options->frame, "Index of the frame, or `last`");
  command->add_option("--frames", options->frames, "Several frames: indices separated by commas, or `all`")
      ->excludes(frame)
      ->type_name("I,J,...");
  command->add_option("--style", options->style, "How bodies are drawn")
      ->check(CLI::IsMember({"surface", "wireframe", "volume", "slices"}));
  command->add_flag("--smooth", options->smooth, "Smooth the steps between voxels");
  command->add_option("--scan", options->scan, "The image for the outlines of --style slices")->type_name("FILE...");
  AddSliceOptions(*command, options->window, options->crop);
  command
      ->add_option("--turntable", options->turntable,
                   "Rotate the view around the body in this number of pictures (GIF)")
      ->check(CLI::Range(2, 360));
  command->add_option("--fps", options->fps, "Pictures per second of a GIF")->check(CLI::Range(0.1, 50.0));
  command->add_option(
      "--colour,--color", options->colour,
      "Quantity to colour by: displacement, a field of the frame, NAME/COMPONENT, a value of lines, or none");
  command->add_option("--range", options->range, "Range of the colour scale, in the field's unit")
      ->expected(2)
      ->type_name("LOW HIGH");
  command->add_flag("--wireframe", options->wireframe, "Draw the edges");
  command->add_flag("--no-surface", options->no_surface, "Do not draw the surface");
  command->add_flag("--no-rest", options->no_rest, "Do not draw the outline of the rest shape");
  command->add_flag("--fibres", options->fibres, "Draw the fibres, through a transparent surface");
  command->add_flag("--no-rigid-bodies", options->no_rigid_bodies, "Omit rigid bodies, such as floors");
  command->add_flag("--no-lines", options->no_lines, "Omit lines, such as the paths of muscles");
  std::vector<std::string> views = {"auto"};
  for (const auto& [view, angles] : Views()) views.push_back(view);
  command->add_option("--view", options->view, "Viewpoint")->check(CLI::IsMember(views));
  std::vector<std::string> verticals;
  for (const auto& [axis, direction] : Verticals()) verticals.push_back(axis);
  command->add_option("--up", options->up, "The vertical of the picture; a floor's normal or z by default")
      ->check(CLI::IsMember(verticals));
  command->add_option("--azimuth", options->azimuth,
                      "Angle of the viewpoint about the vertical; where that is z, from x to y [degree]");
  command->add_option("--elevation", options->elevation, "Angle of the viewpoint above the horizontal [degree]")
      ->check(CLI::Range(-90.0, 90.0));
  command->add_option("--zoom", options->zoom, "Magnification")->check(CLI::Range(0.01, 100.0));
  command->add_option("--size", options->size, "Size of the picture [pixel]")->type_name("WxH");
  command->add_option("--title", options->title, "Title; the scene's name by default");
  command->callback(
      [options, &context] { context.action = [options, &context] { return Render(*options, context); }; });
}

}  // namespace fascicle::client
