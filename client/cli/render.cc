#include <charconv>
#include <iostream>
#include <map>
#include <memory>
#include <optional>

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>

#include "client/cli/command.h"
#include "client/cli/follow.h"
#include "client/cli/outputs.h"

namespace fascicle::client {
namespace {

constexpr const char* kExamples =
    R"(  fascicle render 3f2a --out last.png                             the last frame, coloured by displacement
  fascicle render 3f2a --out f7.png --frame 7 --colour cauchy_stress/zz --wireframe
  fascicle render 3f2a --out fibres.png --fibres --view front --size 900x1200
  fascicle render 3f2a --out a.png --colour volume_ratio --range 0.98 1.02 --azimuth 30 --elevation 15

Needs no display: without one it draws on a virtual one (Xvfb).
)";

struct Options {
  std::string job;
  std::string out;
  std::string frame = "last";
  std::optional<std::string> colour;
  std::vector<double> range;
  bool wireframe = false;
  bool no_surface = false;
  bool no_rest = false;
  bool fibres = false;
  std::string view = "auto";
  std::optional<double> azimuth, elevation;
  double zoom = 1;
  std::string size = "1200x900";
  std::optional<std::string> title;
};

struct Angles {
  double azimuth, elevation;
};

const std::map<std::string, Angles>& Views() {
  static const std::map<std::string, Angles> views = {{"front", {-90, 0}},  {"back", {90, 0}},  {"left", {180, 0}},
                                                      {"right", {0, 0}},    {"top", {-90, 90}}, {"bottom", {-90, -90}},
                                                      {"corner", {-60, 20}}};
  return views;
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

PictureOptions PictureOf(const Options& options, const v1::Job& job, const v1::Frame& frame) {
  PictureOptions picture = DefaultPicture(job, frame);
  picture.size = ParseSize(options.size);
  if (options.colour) picture.colour = *options.colour == "none" ? "" : *options.colour;
  if (!options.range.empty()) picture.range = {options.range[0], options.range[1]};
  picture.surface = !options.no_surface;
  picture.wireframe = options.wireframe;
  picture.rest_outline = !options.no_rest;
  picture.fibres = options.fibres;
  picture.zoom = options.zoom;
  if (const auto view = Views().find(options.view); view != Views().end()) {
    picture.azimuth = view->second.azimuth;
    picture.elevation = view->second.elevation;
  }
  if (options.azimuth) picture.azimuth = options.azimuth;
  if (options.elevation) picture.elevation = options.elevation;
  if (options.title) picture.title = *options.title;
  return picture;
}

int Render(const Options& options, const Context& context) {
  (void)ParseSize(options.size);
  Client client = Connect(context);
  const std::string name = JobName(options.job);
  const v1::Job job = Take(client.GetJob(name));
  if (job.frame_count() == 0) throw CommandError::Invalid(name + " has no frames yet");
  const std::int64_t index = FrameIndex(options.frame, job);
  const Followed followed =
      ReadStored(client, name, index, [](const v1::Geometry&, const v1::Frame&) { return false; });
  if (!followed.last_frame) throw std::runtime_error("the server did not send frame " + std::to_string(index));
  const v1::Frame& frame = *followed.last_frame;
  DrawPicture(followed.geometry, frame, PictureOf(options, job, frame), options.out);
  if (context.json) {
    PrintJson({{"job", name}, {"frame", frame.index()}, {"time", frame.time()}, {"out", options.out}});
  } else {
    std::cout << "frame " << frame.index() << " is in " << options.out << '\n';
  }
  return kDone;
}

}  // namespace

void AddRender(CLI::App& app, Context& context) {
  CLI::App* command = AddCommand(app, "render", "Draw a frame of a job as PNG", kExamples);
  const auto options = std::make_shared<Options>();
  command->add_option("JOB", options->job, "The job")->required();
  command->add_option("--out", options->out, "The picture")->required()->type_name("FILE.png");
  command->add_option("--frame", options->frame, "Index of the frame, or `last`");
  command->add_option("--colour,--color", options->colour,
                      "What to colour by: displacement, a field of the frame, NAME/COMPONENT, or none");
  command->add_option("--range", options->range, "Values at the ends of the colour scale, in the field's unit")
      ->expected(2)
      ->type_name("LOW HIGH");
  command->add_flag("--wireframe", options->wireframe, "Draw the edges");
  command->add_flag("--no-surface", options->no_surface, "Leave the surface out");
  command->add_flag("--no-rest", options->no_rest, "Leave the outline of the rest shape out");
  command->add_flag("--fibres", options->fibres, "Draw the fibres, through a transparent surface");
  std::vector<std::string> views = {"auto"};
  for (const auto& [view, angles] : Views()) views.push_back(view);
  command->add_option("--view", options->view, "Where the eye stands")->check(CLI::IsMember(views));
  command->add_option("--azimuth", options->azimuth, "Angle of the eye around z, from x to y [degree]");
  command->add_option("--elevation", options->elevation, "Angle of the eye above the xy plane [degree]")
      ->check(CLI::Range(-90.0, 90.0));
  command->add_option("--zoom", options->zoom, "Magnification")->check(CLI::Range(0.01, 100.0));
  command->add_option("--size", options->size, "Size of the picture [pixel]")->type_name("WxH");
  command->add_option("--title", options->title, "Heading; the scene's name when not given");
  command->callback(
      [options, &context] { context.action = [options, &context] { return Render(*options, context); }; });
}

}  // namespace fascicle::client
