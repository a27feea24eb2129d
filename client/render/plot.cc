#include "client/render/plot.h"

#include <vtkAxis.h>
#include <vtkChartLegend.h>
#include <vtkChartXY.h>
#include <vtkContextActor.h>
#include <vtkContextScene.h>
#include <vtkDoubleArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPen.h>
#include <vtkPlot.h>
#include <vtkPlotPoints.h>
#include <vtkRenderer.h>
#include <vtkStringArray.h>
#include <vtkTable.h>
#include <vtkTextProperty.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "client/render/ticks.h"

namespace fascicle::client {
namespace {

// Distinguishable by colour-blind readers, too [Okabe and Ito].
constexpr std::array<std::array<unsigned char, 3>, 8> kLineColours = {{{0, 114, 178},
                                                                       {213, 94, 0},
                                                                       {0, 158, 115},
                                                                       {204, 121, 167},
                                                                       {230, 159, 0},
                                                                       {86, 180, 233},
                                                                       {90, 90, 90},
                                                                       {150, 60, 40}}};
constexpr std::array<int, 3> kStyles = {vtkPen::SOLID_LINE, vtkPen::DASH_LINE, vtkPen::DOT_LINE};

struct DataExtent {
  double lowest = INFINITY, highest = -INFINITY;
  void Add(double value) {
    lowest = std::min(lowest, value);
    highest = std::max(highest, value);
  }
};

vtkSmartPointer<vtkTable> MakeTable(const PlotLine& line, DataExtent& x_extent, DataExtent& y_extent) {
  vtkNew<vtkDoubleArray> x, y;
  x->SetName("x");
  y->SetName(line.name.c_str());
  for (std::size_t i = 0; i < std::min(line.x.size(), line.y.size()); ++i) {
    if (!std::isfinite(line.x[i]) || !std::isfinite(line.y[i])) continue;
    x->InsertNextValue(line.x[i]);
    y->InsertNextValue(line.y[i]);
    x_extent.Add(line.x[i]);
    y_extent.Add(line.y[i]);
  }
  auto table = vtkSmartPointer<vtkTable>::New();
  table->AddColumn(x);
  table->AddColumn(y);
  return table;
}

void StyleAxis(vtkAxis& axis, const std::string& label) {
  axis.SetTitle(label);
  axis.GetTitleProperties()->SetFontSize(15);
  axis.GetTitleProperties()->BoldOff();
  axis.GetLabelProperties()->SetFontSize(13);
  axis.GetPen()->SetWidth(Canvas::kSampling);
  axis.GetPen()->SetColor(60, 60, 60);
  axis.GetGridPen()->SetWidth(Canvas::kSampling);
  axis.GetGridPen()->SetColor(232, 232, 232);
}

// Adds a margin, a range around a line that is constant up to round-off, and round ticks.
void SetRange(const DataExtent& extent, double margin, int most_ticks, vtkAxis& axis) {
  const double size = std::max(std::abs(extent.lowest), std::abs(extent.highest));
  double half = margin * (extent.highest - extent.lowest);
  if (!(extent.highest - extent.lowest > 1e-12 * size)) half = size > 0 ? 0.05 * size : 1;
  axis.SetBehavior(vtkAxis::FIXED);
  axis.SetRange(extent.lowest - half, extent.highest + half);
  const Ticks ticks = RoundTicks(extent.lowest - half, extent.highest + half, most_ticks);
  vtkNew<vtkDoubleArray> places;
  vtkNew<vtkStringArray> labels;
  for (std::size_t i = 0; i < ticks.places.size(); ++i) {
    places->InsertNextValue(ticks.places[i]);
    labels->InsertNextValue(ticks.labels[i]);
  }
  axis.SetCustomTickPositions(places, labels);
}

// Puts the plots below each other, with the same margins.
void Align(const std::vector<vtkSmartPointer<vtkChartXY>>& charts) {
  int left = 0, right = charts[0]->GetPoint2()[0];
  for (const auto& chart : charts) {
    left = std::max(left, chart->GetPoint1()[0]);
    right = std::min(right, chart->GetPoint2()[0]);
  }
  for (const auto& chart : charts) {
    const int bottom = chart->GetPoint1()[1], top = chart->GetPoint2()[1];
    chart->SetLayoutStrategy(vtkChart::AXES_TO_RECT);
    chart->SetSize(vtkRectf(static_cast<float>(left), static_cast<float>(bottom), static_cast<float>(right - left),
                            static_cast<float>(top - bottom)));
  }
}

vtkSmartPointer<vtkChartXY> MakeChart(const PlotPanel& panel) {
  auto chart = vtkSmartPointer<vtkChartXY>::New();
  chart->SetAutoSize(false);
  chart->SetTitle(panel.title);
  chart->GetTitleProperties()->SetFontSize(17);
  chart->GetTitleProperties()->BoldOn();
  DataExtent x_extent, y_extent;
  for (std::size_t i = 0; i < panel.lines.size(); ++i) {
    const auto table = MakeTable(panel.lines[i], x_extent, y_extent);
    if (table->GetNumberOfRows() == 0) continue;
    vtkPlot& plot = *chart->AddPlot(panel.lines[i].as_points ? vtkChart::POINTS : vtkChart::LINE);
    plot.SetInputData(table, 0, 1);
    const auto& colour = kLineColours[i % kLineColours.size()];
    plot.SetColor(colour[0], colour[1], colour[2], 255);
    plot.SetWidth(2 * Canvas::kSampling);
    if (auto* points = vtkPlotPoints::SafeDownCast(&plot); points != nullptr && panel.lines[i].as_points) {
      points->SetMarkerStyle(vtkPlotPoints::CIRCLE);
      points->SetMarkerSize(10 * Canvas::kSampling);
    }
    plot.GetPen()->SetLineType(kStyles[i / kLineColours.size() % kStyles.size()]);
  }
  StyleAxis(*chart->GetAxis(vtkAxis::BOTTOM), panel.x_label);
  StyleAxis(*chart->GetAxis(vtkAxis::LEFT), panel.y_label);
  if (x_extent.lowest <= x_extent.highest) {
    // Marks at the ends would be cut.
    const bool marks =
        std::any_of(panel.lines.begin(), panel.lines.end(), [](const PlotLine& l) { return l.as_points; });
    const double x_margin = marks ? 0.02 : 0;
    SetRange(x_extent, x_margin, 11, *chart->GetAxis(vtkAxis::BOTTOM));
    SetRange(y_extent, 0.06, 7, *chart->GetAxis(vtkAxis::LEFT));
  }
  chart->SetShowLegend(true);
  vtkChartLegend& legend = *chart->GetLegend();
  legend.SetInline(false);
  legend.SetHorizontalAlignment(vtkChartLegend::RIGHT);
  legend.SetVerticalAlignment(vtkChartLegend::TOP);
  legend.GetLabelProperties()->SetFontSize(13);
  legend.GetPen()->SetOpacity(0);
  return chart;
}

vtkSmartPointer<vtkImageData> WhitePicture(PictureSize size) {
  auto picture = vtkSmartPointer<vtkImageData>::New();
  picture->SetDimensions(size.width, size.height, 1);
  picture->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
  std::memset(picture->GetScalarPointer(), 255,
              static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height) * 3);
  return picture;
}

// Copies a picture of the same width into the rows from `bottom` on.
void Paste(vtkImageData& band, int bottom, vtkImageData& picture) {
  const std::size_t row = static_cast<std::size_t>(picture.GetDimensions()[0]) * 3;
  std::memcpy(picture.GetScalarPointer(0, bottom, 0), band.GetScalarPointer(),
              row * static_cast<std::size_t>(band.GetDimensions()[1]));
}

}  // namespace

void DrawPlot(const std::vector<PlotPanel>& panels, PictureSize size, const std::filesystem::path& path) {
  if (panels.empty()) throw std::runtime_error("there is nothing to plot");
  // One panel after another: a canvas of the whole height would need much memory, and time to get it.
  const PictureSize band = {size.width, size.height / static_cast<int>(panels.size())};
  Canvas canvas(band);
  vtkNew<vtkRenderer> renderer;
  renderer->SetBackground(1, 1, 1);
  canvas.window().AddRenderer(renderer);
  vtkNew<vtkContextActor> actor;
  renderer->AddActor(actor);
  vtkContextScene& scene = *actor->GetScene();
  scene.SetRenderer(renderer);
  const auto show = [&scene](vtkChartXY& chart) {
    scene.ClearItems();
    scene.AddItem(&chart);
  };
  const float margin = 8 * Canvas::kSampling;
  std::vector<vtkSmartPointer<vtkChartXY>> charts;
  // The first drawing finds the shift that preserves precision where values differ little; the second one applies it to
  // the lines.
  for (const PlotPanel& panel : panels) {
    const auto chart = MakeChart(panel);
    chart->SetSize(vtkRectf(margin, margin, static_cast<float>(canvas.width()) - 2 * margin,
                            static_cast<float>(canvas.height()) - 2 * margin));
    show(*chart);
    canvas.window().Render();
    charts.push_back(chart);
  }
  Align(charts);
  const vtkSmartPointer<vtkImageData> picture = WhitePicture(size);
  int bottom = size.height;
  for (const auto& chart : charts) {
    show(*chart);
    chart->RecalculateBounds();
    bottom -= band.height;
    Paste(*canvas.Grab(), bottom, *picture);
  }
  Canvas::SavePng(*picture, path);
}

}  // namespace fascicle::client
