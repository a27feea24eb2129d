#include "client/render/view.h"

#include <vtkActor2D.h>
#include <vtkAxesActor.h>
#include <vtkCamera.h>
#include <vtkCaptionActor2D.h>
#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkProperty.h>
#include <vtkProperty2D.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "core/base/types.h"

namespace fascicle::client {
namespace {

struct Aim {
  Vec3 eye = Vec3::UnitX();  // from the middle towards the eye, unit
  Vec3 up = Vec3::UnitZ();
};

Aim FromAngles(double azimuth, double elevation, const Vec3& vertical) {
  const double a = azimuth * std::numbers::pi / 180, e = elevation * std::numbers::pi / 180;
  const Mat3 frame = VerticalFrame(vertical);
  // The direction "up" turns with the eye, so that it is well defined when looking straight down.
  return {frame * Vec3(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)),
          frame * Vec3(-std::sin(e) * std::cos(a), -std::sin(e) * std::sin(a), std::cos(e))};
}

Aim ChooseAim(const PictureOptions& options, const Vec3& extent, const std::optional<Vec3>& normal) {
  const std::optional<Vec3> up = options.up ? options.up : normal;
  const Vec3 vertical = up.value_or(Vec3::UnitZ());
  if (options.azimuth || options.elevation || options.up)
    return FromAngles(options.azimuth.value_or(-60), options.elevation.value_or(20), vertical);
  Eigen::Index longest = 0;
  extent.maxCoeff(&longest);
  Vec3 others = extent;
  others[longest] = 0;
  const bool slender = extent[longest] > 1.6 * others.maxCoeff();
  const bool upright = up && std::abs((*up)[longest]) > 0.5;  // such as a body that falls
  if (!slender || upright) return FromAngles(-60, 20, vertical);
  // Across the picture from left to right, seen a little from above its side.
  const Vec3 along = Vec3::Unit(longest);
  Vec3 above = longest == 2 ? Vec3::UnitY() : Vec3::UnitZ();
  if (up) above = (*up - up->dot(along) * along).normalized();
  const Vec3 side = along.cross(above);
  return {(side + 0.3 * above - 0.25 * along).normalized(), above};
}

// 1, 2 or 5 times a power of ten, at most `length`.
double RoundLength(double length) {
  const double power = std::pow(10, std::floor(std::log10(length)));
  for (const double factor : {5.0, 2.0}) {
    if (factor * power <= length) return factor * power;
  }
  return power;
}

std::string LengthText(double metres) {
  char text[32];
  const bool in_mm = metres < 1;
  std::snprintf(text, sizeof text, "%.6g %s", in_mm ? metres * 1e3 : metres, in_mm ? "mm" : "m");
  return text;
}

}  // namespace

Mat3 VerticalFrame(const Vec3& up) {
  Eigen::Index axis = 0;
  up.cwiseAbs().maxCoeff(&axis);
  const double sign = up[axis] < 0 ? -1 : 1;
  Mat3 frame;
  if (axis == 0) {
    frame << 0, 0, sign, sign, 0, 0, 0, 1, 0;  // y, z, x
  } else if (axis == 1) {
    frame << 1, 0, 0, 0, 0, sign, 0, -sign, 0;  // x, -z, y
  } else {
    frame << 1, 0, 0, 0, sign, 0, 0, 0, sign;
  }
  // The rest of the turn, of a floor that is not normal to an axis.
  return Eigen::Quaterniond::FromTwoVectors(Vec3(sign * Vec3::Unit(axis)), up).toRotationMatrix() * frame;
}

void AimCamera(const PictureOptions& options, const double bounds[6], const std::optional<Vec3>& up_of_scene,
               double aspect, vtkRenderer& renderer) {
  const Vec3 low(bounds[0], bounds[2], bounds[4]), high(bounds[1], bounds[3], bounds[5]);
  const Vec3 middle = (low + high) / 2, half = (high - low) / 2;
  const Aim aim = ChooseAim(options, 2 * half, up_of_scene);
  const double radius = std::max(half.norm(), 1e-9);
  vtkCamera& camera = *renderer.GetActiveCamera();
  camera.ParallelProjectionOn();
  const Vec3 up = (aim.up - aim.up.dot(aim.eye) * aim.eye).normalized();
  const Vec3 right = up.cross(aim.eye);
  // What the box covers of the picture, and the part of the picture that is free of texts and scale.
  const double half_width = half.dot(right.cwiseAbs()), half_height = half.dot(up.cwiseAbs());
  constexpr double kFreeWidth = 0.74, kFreeHeight = 0.70;
  const double scale = std::max({half_height / kFreeHeight, half_width / (kFreeWidth * aspect), 1e-9}) / options.zoom;
  // Moves the body left of the colour scale.
  const Vec3 focus = middle + right * (0.08 * scale * aspect) - up * (0.02 * scale);
  const Vec3 position = focus + 4 * radius * aim.eye;
  camera.SetFocalPoint(focus.data());
  camera.SetPosition(position.data());
  camera.SetViewUp(up.data());
  camera.SetParallelScale(scale);
  renderer.ResetCameraClippingRange();
}

void AddLengthBar(double width, double height, vtkRenderer& renderer) {
  const double metres_per_pixel = 2 * renderer.GetActiveCamera()->GetParallelScale() / height;
  const double length = RoundLength(metres_per_pixel * width / 5);
  const double pixels = length / metres_per_pixel;
  const double right = 0.80 * width, y = 0.06 * height, tick = 0.008 * height;
  vtkNew<vtkPoints> points;
  points->InsertNextPoint(right - pixels, y + tick, 0);
  points->InsertNextPoint(right - pixels, y, 0);
  points->InsertNextPoint(right, y, 0);
  points->InsertNextPoint(right, y + tick, 0);
  vtkNew<vtkCellArray> lines;
  lines->InsertNextCell({0, 1, 2, 3});
  vtkNew<vtkPolyData> bar;
  bar->SetPoints(points);
  bar->SetLines(lines);
  vtkNew<vtkPolyDataMapper2D> mapper;
  mapper->SetInputData(bar);
  vtkNew<vtkActor2D> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(0.2, 0.2, 0.2);
  actor->GetProperty()->SetLineWidth(2 * Canvas::kSampling);
  renderer.AddActor2D(actor);
  vtkNew<vtkTextActor> text;
  text->SetInput(LengthText(length).c_str());
  text->GetTextProperty()->SetFontSize(16);
  text->GetTextProperty()->SetColor(0.2, 0.2, 0.2);
  text->GetTextProperty()->SetJustificationToCentered();
  text->SetPosition(right - pixels / 2, y + 1.5 * tick);
  renderer.AddActor2D(text);
}

void AddDirections(vtkRenderWindow& window, vtkRenderer& renderer) {
  vtkNew<vtkRenderer> layer;
  layer->SetLayer(2);
  layer->InteractiveOff();
  const int* size = window.GetSize();
  layer->SetViewport(0.01, 0.01, 0.01 + 0.14 * size[1] / size[0], 0.15);
  vtkNew<vtkAxesActor> axes;
  axes->SetShaftTypeToCylinder();
  axes->SetCylinderRadius(0.05);
  axes->SetConeRadius(0.45);
  axes->SetNormalizedShaftLength(0.75, 0.75, 0.75);
  axes->SetNormalizedTipLength(0.25, 0.25, 0.25);
  double colours[3][3] = {{0.80, 0.25, 0.22}, {0.25, 0.60, 0.28}, {0.22, 0.38, 0.75}};
  axes->GetXAxisShaftProperty()->SetColor(colours[0]);
  axes->GetXAxisTipProperty()->SetColor(colours[0]);
  axes->GetYAxisShaftProperty()->SetColor(colours[1]);
  axes->GetYAxisTipProperty()->SetColor(colours[1]);
  axes->GetZAxisShaftProperty()->SetColor(colours[2]);
  axes->GetZAxisTipProperty()->SetColor(colours[2]);
  axes->SetNormalizedLabelPosition(1.25, 1.25, 1.25);
  axes->SetXAxisLabelText("x");
  axes->SetYAxisLabelText("y");
  axes->SetZAxisLabelText("z");
  for (vtkCaptionActor2D* caption :
       {axes->GetXAxisCaptionActor2D(), axes->GetYAxisCaptionActor2D(), axes->GetZAxisCaptionActor2D()}) {
    caption->GetTextActor()->SetTextScaleModeToNone();
    caption->GetCaptionTextProperty()->SetFontSize(15);
    caption->GetCaptionTextProperty()->SetColor(0.2, 0.2, 0.2);
    caption->GetCaptionTextProperty()->ShadowOff();
    caption->GetCaptionTextProperty()->ItalicOff();
  }
  layer->AddActor(axes);
  vtkCamera& from = *renderer.GetActiveCamera();
  double direction[3], up[3];
  from.GetDirectionOfProjection(direction);
  from.GetViewUp(up);
  vtkCamera& camera = *layer->GetActiveCamera();
  camera.ParallelProjectionOn();
  camera.SetFocalPoint(0, 0, 0);
  camera.SetPosition(-5 * direction[0], -5 * direction[1], -5 * direction[2]);
  camera.SetViewUp(up);
  camera.SetParallelScale(1.6);
  layer->ResetCameraClippingRange(-2, 2, -2, 2, -2, 2);
  window.AddRenderer(layer);
}

}  // namespace fascicle::client
