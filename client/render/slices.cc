#include "client/render/slices.h"

#include <vtkActor2D.h>
#include <vtkImageData.h>
#include <vtkImageMapper.h>
#include <vtkNew.h>
#include <vtkRenderer.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <utility>

namespace fascicle::client {
namespace {

using Colour = std::array<unsigned char, 3>;

// Colours of outlines: bright on grey, and distinguishable by colour-blind readers.
constexpr std::array<Colour, 6> kOutlineColours = {
    {{255, 176, 0}, {86, 180, 233}, {255, 80, 120}, {0, 210, 150}, {220, 130, 255}, {240, 228, 66}}};
constexpr int kColumns = 3, kRows = 2;
constexpr int kMargin = 10 * Canvas::kSampling, kCaption = 22 * Canvas::kSampling, kHead = 36 * Canvas::kSampling,
              kFoot = 40 * Canvas::kSampling;

const Colour& ColourOf(int label) {
  return kOutlineColours[static_cast<std::size_t>(label - 1) % kOutlineColours.size()];
}

// A slice normal to one axis.
struct Panel {
  int across = 2;          // axis
  int right = 0, up = 1;   // axes of the picture
  bool downwards = false;  // `up` runs down
  int at = 0;              // voxel along `across`
};

struct Extent {
  std::array<int, 3> low, high;
};

// Of the labelled voxels; of all where there are none.
Extent LabelledExtent(const SlicesInput& input) {
  Extent extent = {input.size, {-1, -1, -1}};
  std::size_t v = 0;
  for (int k = 0; k < input.size[2]; ++k) {
    for (int j = 0; j < input.size[1]; ++j) {
      for (int i = 0; i < input.size[0]; ++i, ++v) {
        if (input.labels[v] == 0) continue;
        const std::array<int, 3> at = {i, j, k};
        for (int axis = 0; axis < 3; ++axis) {
          extent.low[axis] = std::min(extent.low[axis], at[axis]);
          extent.high[axis] = std::max(extent.high[axis], at[axis]);
        }
      }
    }
  }
  if (extent.high[0] < 0) return {{0, 0, 0}, {input.size[0] - 1, input.size[1] - 1, input.size[2] - 1}};
  return extent;
}

std::vector<Panel> ChoosePanels(const SlicesInput& input) {
  constexpr int kAxial = 4;
  const Extent extent = LabelledExtent(input);
  std::vector<Panel> panels;
  for (int s = 0; s < kAxial; ++s) {
    const double part = (s + 0.5) / kAxial;
    const int at = static_cast<int>(std::lround(extent.low[2] + part * (extent.high[2] - extent.low[2])));
    panels.push_back({2, 0, 1, true, at});
  }
  panels.push_back({1, 0, 2, false, (extent.low[1] + extent.high[1]) / 2});
  panels.push_back({0, 1, 2, false, (extent.low[0] + extent.high[0]) / 2});
  return panels;
}

std::pair<float, float> GreyRange(std::span<const float> values) {
  constexpr std::size_t kMostSamples = 1'000'000;
  std::vector<float> samples;
  const std::size_t step = values.size() / kMostSamples + 1;
  for (std::size_t v = 0; v < values.size(); v += step) samples.push_back(values[v]);
  const auto percentile = [&](double part) {
    const auto at = samples.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(samples.size() - 1));
    std::nth_element(samples.begin(), at, samples.end());
    return *at;
  };
  return {percentile(0.005), percentile(0.995)};
}

// The picture as points, counted from its lower left.
class Raster {
 public:
  Raster(int width, int height) : width_(width), height_(height) {
    data_->SetDimensions(width, height, 1);
    data_->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
    std::fill_n(points(), static_cast<std::size_t>(width) * height * 3, static_cast<unsigned char>(255));
  }
  void Set(int x, int y, const Colour& colour) {
    if (x < 0 || y < 0 || x >= width_ || y >= height_) return;
    std::copy(colour.begin(), colour.end(), points() + 3 * (static_cast<std::size_t>(y) * width_ + x));
  }
  void Fill(int x, int y, int width, int height, const Colour& colour) {
    for (int v = y; v < y + height; ++v) {
      for (int u = x; u < x + width; ++u) Set(u, v, colour);
    }
  }
  vtkImageData* data() { return data_; }

 private:
  unsigned char* points() { return static_cast<unsigned char*>(data_->GetScalarPointer()); }

  int width_, height_;
  vtkNew<vtkImageData> data_;
};

// A slice as a function of places in it, counted in voxels from its lower left corner.
class Slice {
 public:
  Slice(const SlicesInput& input, const Panel& panel) : input_(input), panel_(panel) {}

  double width() const { return input_.size[panel_.right] * input_.spacing[panel_.right]; }  // [m]
  double height() const { return input_.size[panel_.up] * input_.spacing[panel_.up]; }       // [m]

  // At a place [m] from the lower left.
  int LabelAt(double x, double y) const {
    const int right = static_cast<int>(std::floor(x / input_.spacing[panel_.right]));
    const int up = static_cast<int>(std::floor(y / input_.spacing[panel_.up]));
    if (right < 0 || up < 0 || right >= input_.size[panel_.right] || up >= input_.size[panel_.up]) return 0;
    return input_.labels[IndexOf(right, up)];
  }
  // Bilinear between the centres of voxels.
  double ValueAt(double x, double y) const {
    const auto [left, right, a] = Between(x / input_.spacing[panel_.right], input_.size[panel_.right]);
    const auto [low, high, b] = Between(y / input_.spacing[panel_.up], input_.size[panel_.up]);
    const auto value = [&](int r, int u) { return static_cast<double>(input_.values[IndexOf(r, u)]); };
    return (1 - b) * ((1 - a) * value(left, low) + a * value(right, low)) +
           b * ((1 - a) * value(left, high) + a * value(right, high));
  }

 private:
  struct Pair {
    int low, high;
    double weight;
  };
  static Pair Between(double at, int size) {
    at = std::clamp(at - 0.5, 0.0, size - 1.0);
    const int low = static_cast<int>(at);
    return {low, std::min(low + 1, size - 1), at - low};
  }
  std::size_t IndexOf(int right, int up) const {
    std::array<std::size_t, 3> at;
    at[panel_.across] = panel_.at;
    at[panel_.right] = right;
    at[panel_.up] = panel_.downwards ? input_.size[panel_.up] - 1 - up : up;
    return at[0] +
           static_cast<std::size_t>(input_.size[0]) * (at[1] + static_cast<std::size_t>(input_.size[1]) * at[2]);
  }

  const SlicesInput& input_;
  const Panel& panel_;
};

// The slice with its lower left corner at (left, bottom), at so many points a metre.
void Paint(const Slice& slice, double scale, int left, int bottom, std::pair<float, float> grey, Raster& raster) {
  const int width = static_cast<int>(slice.width() * scale), height = static_cast<int>(slice.height() * scale);
  const double half_line = 1.2 * Canvas::kSampling / scale;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double u = (x + 0.5) / scale, v = (y + 0.5) / scale;
      const double range = std::max(grey.second - grey.first, 1e-30F);
      const auto level = static_cast<unsigned char>(
          std::lround(255 * std::clamp((slice.ValueAt(u, v) - grey.first) / range, 0.0, 1.0)));
      Colour colour = {level, level, level};
      // A line inside of the label, along its side.
      const int label = slice.LabelAt(u, v);
      const auto differs = [&](double a, double b) { return slice.LabelAt(u + a, v + b) != label; };
      if (label != 0 &&
          (differs(half_line, 0) || differs(-half_line, 0) || differs(0, half_line) || differs(0, -half_line)))
        colour = ColourOf(label);
      raster.Set(left + x, bottom + y, colour);
    }
  }
}

void AddMark(const std::string& text, int x, int y, int size, bool bold, vtkRenderer& renderer) {
  vtkNew<vtkTextActor> actor;
  actor->SetInput(text.c_str());
  actor->SetPosition(x, y);
  vtkTextProperty& style = *actor->GetTextProperty();
  style.SetColor(0.1, 0.1, 0.1);
  style.SetFontSize(size);
  style.SetBold(bold ? 1 : 0);
  renderer.AddActor2D(actor);
}

// A length of 1, 2 or 5 times a power of ten [m].
double BarLength(double longest) {
  const double power = std::pow(10, std::floor(std::log10(longest)));
  for (const double factor : {5.0, 2.0}) {
    if (factor * power <= longest) return factor * power;
  }
  return power;
}

void AddFoot(const SlicesInput& input, double scale, int width, Raster& raster, vtkRenderer& renderer) {
  const double length = BarLength(0.2 * width / scale);
  const int bar = static_cast<int>(length * scale), right = width - 2 * kMargin;
  raster.Fill(right - bar, kMargin, bar, 3 * Canvas::kSampling, {40, 40, 40});
  char text[32];
  std::snprintf(text, sizeof text, "%.6g mm", length * 1e3);
  AddMark(text, right - bar, kMargin + 6 * Canvas::kSampling, 13, false, renderer);
  int x = 2 * kMargin;
  for (std::size_t l = 0; l < input.names.size(); ++l) {
    const int side = 12 * Canvas::kSampling;
    raster.Fill(x, kMargin, side, side, ColourOf(static_cast<int>(l) + 1));
    AddMark(input.names[l], x + side + kMargin / 2, kMargin, 14, false, renderer);
    x += side + 2 * kMargin + static_cast<int>(input.names[l].size()) * 9 * Canvas::kSampling;
  }
}

}  // namespace

void DrawSlices(const SlicesInput& input, PictureSize size, const std::filesystem::path& path) {
  const std::size_t voxels = static_cast<std::size_t>(input.size[0]) * input.size[1] * input.size[2];
  if (voxels == 0 || input.values.size() != voxels || input.labels.size() != voxels) {
    throw std::runtime_error("there is no image to draw");
  }
  Canvas canvas(size);
  const std::vector<Panel> panels = ChoosePanels(input);
  const int cell_width = canvas.width() / kColumns, cell_height = (canvas.height() - kHead - kFoot) / kRows;
  double scale = 1e30;
  for (const Panel& panel : panels) {
    const Slice slice(input, panel);
    scale = std::min(
        {scale, (cell_width - 2 * kMargin) / slice.width(), (cell_height - kMargin - kCaption) / slice.height()});
  }
  vtkNew<vtkRenderer> renderer;
  renderer->SetBackground(1, 1, 1);
  canvas.window().AddRenderer(renderer);
  Raster raster(canvas.width(), canvas.height());
  vtkNew<vtkImageMapper> mapper;
  mapper->SetInputData(raster.data());
  mapper->SetColorWindow(255);
  mapper->SetColorLevel(127.5);
  vtkNew<vtkActor2D> picture;
  picture->SetMapper(mapper);
  renderer->AddActor2D(picture);
  const auto grey = GreyRange(input.values);
  for (std::size_t p = 0; p < panels.size(); ++p) {
    const Slice slice(input, panels[p]);
    const int column = static_cast<int>(p) % kColumns, row = static_cast<int>(p) / kColumns;
    const int left = column * cell_width + (cell_width - static_cast<int>(slice.width() * scale)) / 2;
    const int top = canvas.height() - kHead - row * cell_height - kCaption;
    Paint(slice, scale, left, top - static_cast<int>(slice.height() * scale), grey, raster);
    const std::string caption = std::string(1, "ijk"[panels[p].across]) + " = " + std::to_string(panels[p].at);
    AddMark(caption, left, top + 5 * Canvas::kSampling, 13, false, *renderer);
  }
  AddMark(input.title, 2 * kMargin, canvas.height() - kHead + 8 * Canvas::kSampling, 17, true, *renderer);
  AddFoot(input, scale, canvas.width(), raster, *renderer);
  canvas.Save(path);
}

}  // namespace fascicle::client
