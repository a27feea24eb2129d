#include "client/render/picture.h"

#include <vtkActor.h>
#include <vtkActor2D.h>
#include <vtkBoundingBox.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkLight.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyDataMapper.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkProperty.h>
#include <vtkProperty2D.h>
#include <vtkRenderer.h>
#include <vtkRendererCollection.h>
#include <vtkScalarBarActor.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "client/lib/decode.h"
#include "client/render/body_cloud.h"
#include "client/render/body_mesh.h"
#include "client/render/colouring.h"
#include "client/render/gif_writer.h"
#include "client/render/line_tubes.h"
#include "client/render/rest_outline.h"
#include "client/render/ticks.h"
#include "client/render/view.h"
#include "client/vtk/body_grid.h"

namespace fascicle::client {
namespace {

constexpr double kInk[3] = {0.2, 0.2, 0.2};
constexpr double kFlesh[3] = {0.78, 0.36, 0.32};
constexpr double kBone[3] = {0.86, 0.83, 0.75};
constexpr double kMuscle[3] = {0.66, 0.16, 0.16};
constexpr int kFibreSeeds = 70;
constexpr double kLineRadius = 0.005;  // of the diagonal of the box around everything
constexpr int kScaleWidth = 230;       // [pixel]
constexpr int kHeadHeight = 44;        // of the title above several panels [pixel]

vtkSmartPointer<vtkActor> MakeActor(vtkPolyData* data, const Colouring& colouring) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(data);
  if (colouring.scale.table == nullptr) {
    mapper->ScalarVisibilityOff();
  } else {
    mapper->SetLookupTable(colouring.scale.table);
    mapper->UseLookupTableScalarRangeOn();
    // Between two categories lies no third one.
    mapper->SetInterpolateScalarsBeforeMapping(!colouring.scale.is_list);
  }
  auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper);
  return actor;
}

vtkSmartPointer<vtkActor> MakeLines(vtkPolyData* data, const double colour[3], double width, double opacity) {
  const auto actor = MakeActor(data, {});
  actor->GetProperty()->SetColor(colour[0], colour[1], colour[2]);
  actor->GetProperty()->SetLineWidth(static_cast<float>(width * Canvas::kSampling));
  actor->GetProperty()->SetOpacity(opacity);
  actor->GetProperty()->LightingOff();
  return actor;
}

void SetMatte(const double colour[3], vtkProperty& property) {
  property.SetColor(colour[0], colour[1], colour[2]);
  property.SetAmbient(0.3);
  property.SetDiffuse(0.75);
  property.SetSpecular(0.12);
  property.SetSpecularPower(25);
}

void AddBody(const BodyShape& shape, const v1::BodyFrame& frame, const Colouring& colouring, std::size_t index,
             const PictureOptions& options, vtkRenderer& renderer) {
  const std::vector<Vec3> positions = DecodePositions(frame, shape.positions.size());
  const std::vector<double>& values = colouring.bodies[index];
  const auto grid = MakeGrid(shape, positions, values);
  if (options.volume) {
    const auto solid = MakeLinearGrid(shape, positions);
    SetColours(values, *solid);
    AddCloud(*solid, colouring.scale, renderer);
  }
  const auto surface = MakeSurface(*grid, options.smooth);
  if (options.surface && !options.volume) {
    const auto actor = MakeActor(surface, colouring);
    vtkProperty& property = *actor->GetProperty();
    SetMatte(kFlesh, property);
    if (options.fibres) property.SetOpacity(0.30);
    renderer.AddActor(actor);
  }
  if (options.wireframe) {
    // On a surface, edges are dark; without a surface, they have the colours.
    const auto data = shape.quadratic() ? MakeCurvedEdges(shape, positions, values) : surface;
    const auto edges = MakeActor(data, options.surface ? Colouring{} : colouring);
    edges->GetProperty()->SetRepresentationToWireframe();
    edges->GetProperty()->SetLineWidth(Canvas::kSampling * (options.surface ? 0.8F : 1.2F));
    edges->GetProperty()->SetColor(kInk[0], kInk[1], kInk[2]);
    edges->GetProperty()->LightingOff();
    if (options.surface) {
      edges->GetProperty()->SetOpacity(0.55);
      edges->GetMapper()->SetRelativeCoincidentTopologyLineOffsetParameters(-1, -1);
      edges->GetMapper()->SetResolveCoincidentTopologyToPolygonOffset();
    }
    renderer.AddActor(edges);
  }
  if (options.fibres) {
    constexpr double kFibreColour[3] = {0.45, 0.06, 0.08};
    renderer.AddActor(MakeLines(MakeFibreLines(shape, positions, kFibreSeeds), kFibreColour, 1.1, 1));
  }
}

// A plane is transparent from behind, so that a floor hides nothing from below.
void AddRigidBody(const RigidShape& body, const Pose& pose, vtkRenderer& renderer) {
  if (body.triangles.empty()) return;
  const auto surface = MakeSurface(*MakeGrid(body, pose));
  const auto front = MakeActor(surface, {});
  SetMatte(kBone, *front->GetProperty());
  renderer.AddActor(front);
  if (!body.unbounded) return;
  front->GetProperty()->BackfaceCullingOn();
  const auto back = MakeActor(surface, {});
  SetMatte(kBone, *back->GetProperty());
  back->GetProperty()->FrontfaceCullingOn();
  back->GetProperty()->SetOpacity(0.25);
  renderer.AddActor(back);
}

void AddLine(const LinePath& path, const std::optional<double>& value, const ColourScale& scale, double radius,
             vtkRenderer& renderer) {
  const auto actor = MakeActor(MakeTube(path.points, radius), {});
  SetMatte(kMuscle, *actor->GetProperty());
  if (value && scale.table != nullptr) {
    double colour[3];
    scale.table->GetColor(*value, colour);
    SetMatte(colour, *actor->GetProperty());
  }
  renderer.AddActor(actor);
}

// The outline of the rest shape as the camera sees it, over everything else.
void AddRestOutlines(const std::vector<BodyShape>& shapes, vtkRenderer& renderer, vtkRenderer& overlay) {
  Vec3 towards;
  renderer.GetActiveCamera()->GetDirectionOfProjection(towards.data());
  for (const BodyShape& shape : shapes) {
    // For voxels only the silhouette, because their edges are everywhere.
    const bool voxels = IsOfVoxels(shape);
    const auto surface = MakeSurface(*MakeGrid(shape, shape.positions), voxels);
    overlay.AddActor(MakeLines(MakeRestOutline(*surface, -towards, !voxels), kInk, 1.3, 0.45));
  }
}

void AddText(const std::string& text, double x, double y, int size, bool bold, vtkRenderer& renderer,
             const double colour[3] = kInk) {
  vtkNew<vtkTextActor> actor;
  actor->SetInput(text.c_str());
  actor->GetTextProperty()->SetFontSize(size);
  actor->GetTextProperty()->SetColor(colour[0], colour[1], colour[2]);
  actor->GetTextProperty()->SetBold(bold);
  actor->GetTextProperty()->SetVerticalJustificationToTop();
  actor->GetPositionCoordinate()->SetCoordinateSystemToNormalizedViewport();
  actor->SetPosition(x, y);
  renderer.AddActor2D(actor);
}

// A filled square with its lower left corner at (x, y) [pixel drawn].
void AddSquare(double x, double y, double side, const double colour[3], vtkRenderer& renderer) {
  vtkNew<vtkPoints> points;
  points->InsertNextPoint(x, y, 0);
  points->InsertNextPoint(x + side, y, 0);
  points->InsertNextPoint(x + side, y + side, 0);
  points->InsertNextPoint(x, y + side, 0);
  vtkNew<vtkCellArray> faces;
  faces->InsertNextCell({0, 1, 2, 3});
  vtkNew<vtkPolyData> square;
  square->SetPoints(points);
  square->SetPolys(faces);
  vtkNew<vtkPolyDataMapper2D> mapper;
  mapper->SetInputData(square);
  vtkNew<vtkActor2D> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(colour[0], colour[1], colour[2]);
  renderer.AddActor2D(actor);
}

// The names of categories in their colours, below each other at the right.
void AddCategories(const Colouring& colouring, const std::vector<std::string>& names, double width, double height,
                   vtkRenderer& renderer) {
  const double pixel = Canvas::kSampling / width, line = 26 * Canvas::kSampling / height;
  for (std::size_t i = 0; i < names.size(); ++i) {
    double colour[3];
    colouring.scale.table->GetColor(static_cast<double>(i), colour);
    const double y = 0.80 - static_cast<double>(i) * line;
    AddSquare(width * (1 - 180 * pixel), height * (y - 0.68 * line), 14 * Canvas::kSampling, colour, renderer);
    AddText(names[i], 1 - 158 * pixel, y, 16, false, renderer);
  }
}

// `width` and `height` are those of the renderer, before downsampling [pixel].
void AddScale(const Colouring& colouring, const std::vector<std::string>& categories, double width, double height,
              vtkRenderer& renderer) {
  if (colouring.scale.table == nullptr) return;
  if (colouring.scale.is_list) return AddCategories(colouring, categories, width, height, renderer);
  vtkNew<vtkScalarBarActor> bar;
  bar->SetLookupTable(colouring.scale.table);
  const Ticks ticks = RoundTicks(colouring.scale.lowest, colouring.scale.highest, 7);
  vtkNew<vtkDoubleArray> places;
  for (const double place : ticks.places) places->InsertNextValue(place);
  bar->SetCustomLabels(places);
  bar->SetUseCustomLabels(ticks.places.size() > 1);
  bar->SetMaximumNumberOfColors(256);
  bar->SetLabelFormat("  %.6g");  // the spaces separate the numbers from the bar
  bar->UnconstrainedFontSizeOn();
  bar->GetLabelTextProperty()->SetFontSize(16);
  bar->GetLabelTextProperty()->SetColor(kInk);
  bar->GetLabelTextProperty()->ItalicOff();
  bar->GetLabelTextProperty()->BoldOff();
  bar->GetLabelTextProperty()->ShadowOff();
  bar->SetBarRatio(0.22);
  bar->GetPositionCoordinate()->SetCoordinateSystemToNormalizedViewport();
  const double pixel = Canvas::kSampling / width;
  bar->SetPosition(1 - 168 * pixel, 0.16);
  bar->SetWidth(144 * pixel);
  bar->SetHeight(0.62);
  bar->DrawFrameOff();
  renderer.AddActor2D(bar);
  vtkNew<vtkTextActor> title;
  title->SetInput(colouring.title.c_str());
  title->GetTextProperty()->SetFontSize(17);
  title->GetTextProperty()->SetColor(kInk);
  title->GetTextProperty()->SetJustificationToRight();
  title->GetTextProperty()->SetVerticalJustificationToBottom();
  title->GetPositionCoordinate()->SetCoordinateSystemToNormalizedViewport();
  title->SetPosition(1 - 24 * pixel, 0.81);
  renderer.AddActor2D(title);
  if (!colouring.note.empty()) AddText(colouring.note, 1 - 196 * pixel, 0.14, 13, false, renderer);
}

std::string TimeText(const v1::Frame& frame) {
  char text[64];
  std::snprintf(text, sizeof text, "t = %.4g s   (frame %lld)", frame.time(), static_cast<long long>(frame.index()));
  return text;
}

// Data shared by all panels of a picture.
struct Setting {
  std::vector<BodyShape> shapes;
  std::vector<RigidShape> rigid_bodies;
  std::vector<LineInfo> lines;
  std::vector<Colouring> colourings;  // of each frame
  std::array<double, 6> bounds;       // of everything drawn in all frames, except planes, in VTK's order [m]
  std::optional<Vec3> up;             // outward normal of the first plane
  double line_radius = 0;             // [m]
};

void AddPoints(const std::vector<Vec3>& points, vtkBoundingBox& box) {
  for (const Vec3& x : points) box.AddPoint(x[0], x[1], x[2]);
}

vtkBoundingBox BoundsOf(const Setting& setting, std::span<const v1::Frame> frames, const PictureOptions& options) {
  vtkBoundingBox box;
  for (const BodyShape& shape : setting.shapes) {
    if (options.rest_outline) AddPoints(shape.positions, box);
  }
  for (const v1::Frame& frame : frames) {
    for (std::size_t i = 0; i < setting.shapes.size(); ++i) {
      AddPoints(DecodePositions(frame.bodies(static_cast<int>(i)), setting.shapes[i].positions.size()), box);
    }
    const std::vector<Pose> poses = PosesOf(frame, setting.rigid_bodies);
    for (std::size_t i = 0; i < poses.size() && options.rigid_bodies; ++i) {
      const RigidShape& body = setting.rigid_bodies[i];
      if (!body.unbounded) AddPoints(PositionsAt(body, poses[i]), box);
    }
    for (const LinePath& line : DecodeLines(frame, setting.lines)) {
      if (options.lines) AddPoints(line.points, box);
    }
  }
  return box;
}

Setting MakeSetting(const v1::Geometry& geometry, std::span<const v1::Frame> frames, const PictureOptions& options) {
  Setting setting;
  for (const v1::Frame& frame : frames) CheckFits(frame, geometry);
  setting.shapes = DecodeGeometry(geometry);
  setting.rigid_bodies = DecodeRigidBodies(geometry);
  setting.lines = DecodeLineInfos(geometry);
  setting.colourings =
      ColourFrames(setting.shapes, setting.lines, geometry.series(), frames, options.colour, options.range);
  for (Colouring& colouring : setting.colourings) {
    if (!options.categories.empty()) colouring.scale = MakeCategories(static_cast<int>(options.categories.size()));
  }
  const vtkBoundingBox box = BoundsOf(setting, frames, options);
  if (box.IsValid() == 0) throw std::runtime_error("there is nothing to draw in the frame");
  box.GetBounds(setting.bounds.data());
  for (const RigidShape& body : setting.rigid_bodies) {
    if (!body.unbounded) continue;
    setting.up = RotationOf(body.pose).col(2);
    break;
  }
  setting.line_radius = kLineRadius * box.GetDiagonalLength();
  return setting;
}

// A part of a picture: [left, right] x [bottom, top], as fractions of it.
struct Part {
  double left = 0, bottom = 0, right = 1, top = 1;
};

void AddLights(vtkRenderer& renderer) {
  // From above the camera, so that faces turned upwards are not black.
  vtkNew<vtkLight> above;
  above->SetLightTypeToCameraLight();
  above->SetPosition(0.3, 1, 0.4);
  above->SetIntensity(0.45);
  renderer.AddLight(above);
  vtkNew<vtkLight> eye;
  eye->SetLightTypeToHeadlight();
  eye->SetIntensity(0.75);
  renderer.AddLight(eye);
}

vtkSmartPointer<vtkRenderer> AddBackground(const Part& part, Canvas& canvas) {
  auto renderer = vtkSmartPointer<vtkRenderer>::New();
  renderer->SetViewport(part.left, part.bottom, part.right, part.top);
  renderer->SetBackground(0.90, 0.92, 0.95);
  renderer->SetBackground2(1, 1, 1);
  renderer->GradientBackgroundOn();
  canvas.window().AddRenderer(renderer);
  return renderer;
}

// The white band of a title above several panels.
void AddHead(const Part& part, Canvas& canvas) {
  vtkNew<vtkRenderer> renderer;
  renderer->SetViewport(part.left, part.bottom, part.right, part.top);
  renderer->SetBackground(1, 1, 1);
  canvas.window().AddRenderer(renderer);
}

// Draws one frame into a part of the canvas. The last panel has the length bar.
vtkSmartPointer<vtkRenderer> AddPanel(const Setting& setting, const v1::Frame& frame, std::size_t index,
                                      const PictureOptions& options, const Part& part, bool last, Canvas& canvas) {
  const double width = canvas.width() * (part.right - part.left), height = canvas.height() * (part.top - part.bottom);
  const auto renderer = AddBackground(part, canvas);
  renderer->SetUseDepthPeeling(!options.volume);  // rays are blended with everything drawn before
  renderer->SetMaximumNumberOfPeels(12);
  renderer->SetOcclusionRatio(0);
  for (std::size_t i = 0; i < setting.shapes.size(); ++i) {
    AddBody(setting.shapes[i], frame.bodies(static_cast<int>(i)), setting.colourings[index], i, options, *renderer);
  }
  if (options.rigid_bodies) {
    const std::vector<Pose> poses = PosesOf(frame, setting.rigid_bodies);
    for (std::size_t i = 0; i < poses.size(); ++i) AddRigidBody(setting.rigid_bodies[i], poses[i], *renderer);
  }
  if (options.lines) {
    const Colouring& colouring = setting.colourings[index];
    const std::vector<LinePath> lines = DecodeLines(frame, setting.lines);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      AddLine(lines[i], colouring.lines[i], colouring.scale, setting.line_radius, *renderer);
    }
  }
  AddLights(*renderer);
  AimCamera(options, setting.bounds.data(), setting.up, width / height, *renderer);
  vtkNew<vtkRenderer> overlay;
  overlay->SetLayer(1);
  overlay->SetViewport(renderer->GetViewport());
  overlay->SetActiveCamera(renderer->GetActiveCamera());
  canvas.window().AddRenderer(overlay);
  if (options.rest_outline) AddRestOutlines(setting.shapes, *renderer, *overlay);
  // Below the title of a single panel; several have their title above all of them.
  const bool alone = part.right - part.left == 1 && part.top - part.bottom == 1;
  const double below = (alone ? 45.0 : 0.0) * Canvas::kSampling / height;
  if (options.time) AddText(TimeText(frame), 0.025, 0.965 - below, alone ? 17 : 15, false, *renderer);
  if (last) AddLengthBar(width, height, *renderer);
  return renderer;
}

// Rows and columns for the given number of panels, such that panels are as square as possible.
std::pair<int, int> LayOut(std::size_t count, const PictureSize& size) {
  int columns = 1;
  const auto shape = [&](int c) {
    const int rows = (static_cast<int>(count) + c - 1) / c;
    return std::abs(std::log(static_cast<double>(size.width) / c * rows / size.height));
  };
  for (int c = 2; c <= static_cast<int>(count); ++c) {
    if (shape(c) < shape(columns)) columns = c;
  }
  return {(static_cast<int>(count) + columns - 1) / columns, columns};
}

void AddPanels(const Setting& setting, std::span<const v1::Frame> frames, std::size_t first_index,
               const PictureOptions& options, Canvas& canvas) {
  canvas.window().SetNumberOfLayers(3);
  // The scale is beside several panels; a single panel leaves space for it.
  const Colouring& colouring = setting.colourings[first_index];
  const bool beside = frames.size() > 1 && colouring.scale.table != nullptr;
  const double right = beside ? 1 - static_cast<double>(kScaleWidth) / options.size.width : 1;
  const double top =
      frames.size() > 1 && !options.title.empty() ? 1 - static_cast<double>(kHeadHeight) / options.size.height : 1;
  const auto [rows, columns] = LayOut(
      frames.size(), {static_cast<int>(right * options.size.width), static_cast<int>(top * options.size.height)});
  vtkSmartPointer<vtkRenderer> of_scale;
  for (int cell = 0; cell < rows * columns; ++cell) {
    const int row = cell / columns, column = cell % columns;
    const Part part = {right * column / columns, top * (1 - static_cast<double>(row + 1) / rows),
                       right * (column + 1) / columns, top * (1 - static_cast<double>(row) / rows)};
    const auto f = static_cast<std::size_t>(cell);
    if (f < frames.size()) {
      of_scale = AddPanel(setting, frames[f], first_index + f, options, part, f + 1 == frames.size(), canvas);
    } else {
      AddBackground(part, canvas);
    }
  }
  if (top < 1) AddHead({0, top, 1, 1}, canvas);
  if (beside) of_scale = AddBackground({right, 0, 1, top}, canvas);
  AddScale(colouring, options.categories, canvas.width() * (beside ? 1 - right : 1),
           canvas.height() * (beside ? top : 1), *of_scale);
  // The title may be wider than a panel.
  vtkNew<vtkRenderer> over_all;
  over_all->SetLayer(1);
  canvas.window().AddRenderer(over_all);
  AddText(options.title, top < 1 ? 0.012 : 0.025, top < 1 ? 1 - 0.2 * (1 - top) : 0.965, 22, true, *over_all);
  AddDirections(canvas.window(), *canvas.window().GetRenderers()->GetFirstRenderer());
}

}  // namespace

void DrawPicture(const v1::Geometry& geometry, const v1::Frame& frame, const PictureOptions& options,
                 const std::filesystem::path& path) {
  DrawPanels(geometry, {&frame, 1}, options, path);
}

void DrawPanels(const v1::Geometry& geometry, std::span<const v1::Frame> frames, const PictureOptions& options,
                const std::filesystem::path& path) {
  constexpr std::size_t kMostPanels = 24;
  if (frames.empty() || frames.size() > kMostPanels) throw std::runtime_error("a picture has 1 to 24 panels");
  const Setting setting = MakeSetting(geometry, frames, options);
  Canvas canvas(options.size);
  AddPanels(setting, frames, 0, options, canvas);
  canvas.Save(path);
}

void DrawAnimation(const v1::Geometry& geometry, std::span<const v1::Frame> frames, const PictureOptions& options,
                   const AnimationOptions& animation, const std::filesystem::path& path,
                   const std::function<void(double)>& progress) {
  if (frames.empty()) throw std::runtime_error("an animation needs at least one frame");
  const std::span<const v1::Frame> shown = animation.turntable > 0 ? frames.last(1) : frames;
  const Setting setting = MakeSetting(geometry, shown, options);
  const std::size_t count = animation.turntable > 0 ? static_cast<std::size_t>(animation.turntable) : shown.size();
  Canvas canvas(options.size);
  GifWriter gif(options.size, animation.frames_per_second);
  for (std::size_t f = 0; f < count; ++f) {
    PictureOptions turned = options;
    if (animation.turntable > 0) {
      turned.azimuth = options.azimuth.value_or(-60) + 360.0 * static_cast<double>(f) / static_cast<double>(count);
      turned.elevation = options.elevation.value_or(20);
    }
    canvas.Clear();
    const std::size_t at = animation.turntable > 0 ? 0 : f;
    AddPanels(setting, shown.subspan(at, 1), at, turned, canvas);
    gif.Add(*canvas.Grab());
    if (progress) progress(static_cast<double>(f + 1) / static_cast<double>(count));
  }
  gif.Save(path);
}

}  // namespace fascicle::client
