#include "client/render/picture.h"

#include <vtkActor.h>
#include <vtkBoundingBox.h>
#include <vtkLight.h>
#include <vtkNew.h>
#include <vtkPolyDataMapper.h>
#include <vtkPolyDataSilhouette.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>
#include <vtkScalarBarActor.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "client/lib/decode.h"
#include "client/render/body_mesh.h"
#include "client/render/colour_scale.h"
#include "client/render/field_values.h"
#include "client/render/view.h"

namespace fascicle::client {
namespace {

constexpr double kInk[3] = {0.2, 0.2, 0.2};
constexpr int kFibreSeeds = 70;

struct Colouring {
  std::vector<std::vector<double>> values;  // for each body: one for each node; empty without colour
  std::string title;
  ColourScale scale;
};

Colouring ColourBodies(const std::vector<BodyShape>& shapes, const v1::Frame& frame, const PictureOptions& options) {
  Colouring colouring;
  colouring.values.resize(shapes.size());
  if (options.colour.empty()) return colouring;
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  std::string title, unit;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    NodeValues nodes = ValuesAtNodes(shapes[i], frame.bodies(static_cast<int>(i)), options.colour);
    for (const double value : nodes.values) {
      lowest = std::min(lowest, value);
      highest = std::max(highest, value);
    }
    colouring.values[i] = std::move(nodes.values);
    title = nodes.title;
    unit = nodes.unit;
  }
  if (options.range) std::tie(lowest, highest) = *options.range;
  const ReadableUnit readable = MakeReadable(std::max(std::abs(lowest), std::abs(highest)), unit);
  for (auto& values : colouring.values) {
    for (double& value : values) value *= readable.factor;
  }
  colouring.scale = MakeColourScale(lowest * readable.factor, highest * readable.factor, options.range.has_value());
  std::replace(title.begin(), title.end(), '_', ' ');
  colouring.title = title + (readable.name.empty() ? "" : " [" + readable.name + "]");
  return colouring;
}

vtkSmartPointer<vtkActor> MakeActor(vtkPolyData* data, const Colouring& colouring) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(data);
  if (colouring.scale.table == nullptr) {
    mapper->ScalarVisibilityOff();
  } else {
    mapper->SetLookupTable(colouring.scale.table);
    mapper->UseLookupTableScalarRangeOn();
    mapper->InterpolateScalarsBeforeMappingOn();
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

void AddBody(const BodyShape& shape, const v1::BodyFrame& frame, const Colouring& colouring, std::size_t index,
             const PictureOptions& options, vtkRenderer& renderer) {
  const std::vector<Vec3> positions = DecodePositions(frame, shape.positions.size());
  const auto surface = MakeSurface(*MakeGrid(shape, positions, colouring.values[index]));
  if (options.surface) {
    const auto actor = MakeActor(surface, colouring);
    vtkProperty& property = *actor->GetProperty();
    property.SetColor(0.78, 0.36, 0.32);
    property.SetAmbient(0.3);
    property.SetDiffuse(0.75);
    property.SetSpecular(0.12);
    property.SetSpecularPower(25);
    if (options.fibres) property.SetOpacity(0.30);
    renderer.AddActor(actor);
  }
  if (options.wireframe) {
    // Over a surface the edges are ink; alone they carry the colours.
    const auto edges = MakeActor(surface, options.surface ? Colouring{} : colouring);
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

// The outline of the rest shape as the camera sees it, over everything else.
void AddRestOutlines(const std::vector<BodyShape>& shapes, vtkRenderer& renderer, vtkRenderer& overlay) {
  for (const BodyShape& shape : shapes) {
    vtkNew<vtkPolyDataSilhouette> silhouette;
    silhouette->SetInputData(MakeSurface(*MakeGrid(shape, shape.positions, {})));
    silhouette->SetCamera(renderer.GetActiveCamera());
    silhouette->SetEnableFeatureAngle(60);
    silhouette->Update();
    overlay.AddActor(MakeLines(silhouette->GetOutput(), kInk, 1.3, 0.45));
  }
}

void AddText(const std::string& text, double x, double y, int size, bool bold, vtkRenderer& renderer) {
  vtkNew<vtkTextActor> actor;
  actor->SetInput(text.c_str());
  actor->GetTextProperty()->SetFontSize(size);
  actor->GetTextProperty()->SetColor(kInk);
  actor->GetTextProperty()->SetBold(bold);
  actor->GetTextProperty()->SetVerticalJustificationToTop();
  actor->GetPositionCoordinate()->SetCoordinateSystemToNormalizedViewport();
  actor->SetPosition(x, y);
  renderer.AddActor2D(actor);
}

void AddScale(const Colouring& colouring, vtkRenderer& renderer) {
  if (colouring.scale.table == nullptr) return;
  vtkNew<vtkScalarBarActor> bar;
  bar->SetLookupTable(colouring.scale.table);
  bar->SetNumberOfLabels(6);
  bar->SetMaximumNumberOfColors(256);
  bar->SetLabelFormat("  %.4g");  // the spaces keep the numbers off the bar
  bar->UnconstrainedFontSizeOn();
  bar->GetLabelTextProperty()->SetFontSize(16);
  bar->GetLabelTextProperty()->SetColor(kInk);
  bar->GetLabelTextProperty()->ItalicOff();
  bar->GetLabelTextProperty()->BoldOff();
  bar->GetLabelTextProperty()->ShadowOff();
  bar->SetBarRatio(0.22);
  bar->GetPositionCoordinate()->SetCoordinateSystemToNormalizedViewport();
  bar->SetPosition(0.86, 0.16);
  bar->SetWidth(0.12);
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
  title->SetPosition(0.98, 0.81);
  renderer.AddActor2D(title);
}

std::string TimeText(const v1::Frame& frame) {
  char text[64];
  std::snprintf(text, sizeof text, "t = %.4g s   (frame %lld)", frame.time(), static_cast<long long>(frame.index()));
  return text;
}

}  // namespace

void DrawPicture(const v1::Geometry& geometry, const v1::Frame& frame, const PictureOptions& options,
                 const std::filesystem::path& path) {
  CheckFits(frame, geometry);
  const std::vector<BodyShape> shapes = DecodeGeometry(geometry);
  const Colouring colouring = ColourBodies(shapes, frame, options);
  Canvas canvas(options.size);
  vtkNew<vtkRenderer> renderer;
  renderer->SetBackground(0.90, 0.92, 0.95);
  renderer->SetBackground2(1, 1, 1);
  renderer->GradientBackgroundOn();
  renderer->SetUseDepthPeeling(true);
  renderer->SetMaximumNumberOfPeels(12);
  renderer->SetOcclusionRatio(0);
  canvas.window().AddRenderer(renderer);
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    AddBody(shapes[i], frame.bodies(static_cast<int>(i)), colouring, i, options, *renderer);
  }
  // From above the eye, so that faces that look up are not black.
  vtkNew<vtkLight> above;
  above->SetLightTypeToCameraLight();
  above->SetPosition(0.3, 1, 0.4);
  above->SetIntensity(0.45);
  renderer->AddLight(above);
  vtkNew<vtkLight> eye;
  eye->SetLightTypeToHeadlight();
  eye->SetIntensity(0.75);
  renderer->AddLight(eye);
  double bounds[6];
  renderer->ComputeVisiblePropBounds(bounds);
  AimCamera(options, bounds, *renderer);
  vtkNew<vtkRenderer> overlay;
  overlay->SetLayer(1);
  overlay->SetActiveCamera(renderer->GetActiveCamera());
  canvas.window().SetNumberOfLayers(3);
  canvas.window().AddRenderer(overlay);
  if (options.rest_outline) AddRestOutlines(shapes, *renderer, *overlay);
  AddText(options.title, 0.025, 0.965, 22, true, *renderer);
  if (options.time) AddText(TimeText(frame), 0.025, 0.915, 17, false, *renderer);
  AddScale(colouring, *renderer);
  AddLengthBar(canvas, *renderer);
  AddDirections(canvas.window(), *renderer);
  canvas.Save(path);
}

}  // namespace fascicle::client
