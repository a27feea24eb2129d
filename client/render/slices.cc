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
constexpr int kMargin = 10 * Canvas::kSampling, kCaption = 22 * Canvas::kSampling, kHead = 36 * Canvas::kSampling,
              kFoot = 40 * Canvas::kSampling;

const Colour& ColourOf(int label) {
  return kOutlineColours[static_cast<std::size_t>(label - 1) % kOutlineColours.size()];
}

// An axis of the image along one of the patient, perhaps backwards.
struct ImageAxis {
  int axis = 0;
  bool backwards = false;
};

// The axes of the image nearest to the patient's x (to the left), y (to the back) and z (to the head).
std::array<ImageAxis, 3> PatientAxes(const Mat3& direction) {
  std::array<int, 3> best = {0, 1, 2}, order = best;
  double most = -1;
  do {
    double sum = 0;
    for (int d = 0; d < 3; ++d) sum += std::abs(direction(d, order[static_cast<std::size_t>(d)]));
    if (sum > most + 1e-9) {
      most = sum;
      best = order;
    }
  } while (std::next_permutation(order.begin(), order.end()));
  std::array<ImageAxis, 3> axes;
  for (std::size_t d = 0; d < 3; ++d) axes[d] = {best[d], direction(static_cast<int>(d), best[d]) < 0};
  return axes;
}

struct Extent {
  std::array<int, 3> low, high;  // both inside
};

// A slice normal to one axis, of the voxels within `shown`.
struct Panel {
  int across = 2;                                       // axis
  ImageAxis right, up;                                  // of the picture
  std::array<const char*, 4> sides = {"", "", "", ""};  // marks at the left, right, below and above
  int at = 0;                                           // voxel along `across`
  Extent shown;

  int size(int axis) const { return shown.high[axis] - shown.low[axis] + 1; }
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

// The voxels to show: all, or the labelled ones with a margin.
Extent ShownExtent(const SlicesInput& input, const Extent& labelled) {
  Extent shown = {{0, 0, 0}, {input.size[0] - 1, input.size[1] - 1, input.size[2] - 1}};
  for (int axis = 0; input.crop && axis < 3; ++axis) {
    const int margin = static_cast<int>(std::ceil(*input.crop / input.spacing[axis]));
    shown.low[axis] = std::max(shown.low[axis], labelled.low[axis] - margin);
    shown.high[axis] = std::min(shown.high[axis], labelled.high[axis] + margin);
  }
  return shown;
}

std::vector<Panel> ChoosePanels(const SlicesInput& input) {
  constexpr int kAxial = 4;
  const Extent extent = LabelledExtent(input);
  const Extent shown = ShownExtent(input, extent);
  const auto [left, back, head] = PatientAxes(input.direction);
  const auto reversed = [](ImageAxis axis) { return ImageAxis{axis.axis, !axis.backwards}; };
  const auto middle = [&](const ImageAxis& axis) { return (extent.low[axis.axis] + extent.high[axis.axis]) / 2; };
  std::vector<Panel> panels;
  for (int s = 0; s < kAxial; ++s) {  // from the foot to the head
    const double part = head.backwards ? 1 - (s + 0.5) / kAxial : (s + 0.5) / kAxial;
    const int low = extent.low[head.axis], high = extent.high[head.axis];
    const int at = static_cast<int>(std::lround(low + part * (high - low)));
    panels.push_back({head.axis, left, reversed(back), {"R", "L", "P", "A"}, at, shown});
  }
  panels.push_back({back.axis, left, head, {"R", "L", "F", "H"}, middle(back), shown});
  panels.push_back({left.axis, back, head, {"A", "P", "F", "H"}, middle(left), shown});
  return panels;
}

// The values drawn in black and in white.
std::pair<float, float> GreyRange(const SlicesInput& input) {
  if (input.window) {
    const auto [level, width] = *input.window;
    return {static_cast<float>(level - width / 2), static_cast<float>(level + width / 2)};
  }
  const std::span<const float> values = input.values;
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

// A slice as a function of places in it.
class Slice {
 public:
  Slice(const SlicesInput& input, const Panel& panel) : input_(input), panel_(panel) {}

  double width() const { return panel_.size(panel_.right.axis) * input_.spacing[panel_.right.axis]; }  // [m]
  double height() const { return panel_.size(panel_.up.axis) * input_.spacing[panel_.up.axis]; }       // [m]

  // At a place [m] from the lower left.
  int LabelAt(double x, double y) const {
    const int right = static_cast<int>(std::floor(x / input_.spacing[panel_.right.axis]));
    const int up = static_cast<int>(std::floor(y / input_.spacing[panel_.up.axis]));
    if (right < 0 || up < 0 || right >= panel_.size(panel_.right.axis) || up >= panel_.size(panel_.up.axis)) return 0;
    return input_.labels[IndexOf(right, up)];
  }
  // Bilinear between the centres of voxels.
  double ValueAt(double x, double y) const {
    const auto [left, right, a] = Between(x / input_.spacing[panel_.right.axis], panel_.size(panel_.right.axis));
    const auto [low, high, b] = Between(y / input_.spacing[panel_.up.axis], panel_.size(panel_.up.axis));
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
    const auto place = [&](const ImageAxis& axis, int steps) {
      return static_cast<std::size_t>(axis.backwards ? panel_.shown.high[axis.axis] - steps
                                                     : panel_.shown.low[axis.axis] + steps);
    };
    at[panel_.across] = static_cast<std::size_t>(panel_.at);
    at[panel_.right.axis] = place(panel_.right, right);
    at[panel_.up.axis] = place(panel_.up, up);
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

constexpr double kTextInk[3] = {0.1, 0.1, 0.1}, kSideInk[3] = {1, 0.85, 0.3};

void AddMark(const std::string& text, int x, int y, int size, bool bold, vtkRenderer& renderer,
             const double colour[3] = kTextInk) {
  vtkNew<vtkTextActor> actor;
  actor->SetInput(text.c_str());
  actor->SetPosition(x, y);
  vtkTextProperty& style = *actor->GetTextProperty();
  style.SetColor(colour[0], colour[1], colour[2]);
  style.SetFontSize(size);
  style.SetBold(bold ? 1 : 0);
  if (colour != kTextInk) {  // legible on bright tissue, too
    style.SetBackgroundColor(0.1, 0.1, 0.1);
    style.SetBackgroundOpacity(0.6);
  }
  renderer.AddActor2D(actor);
}

// R, L, A, P, H and F in the middle of the sides of a slice.
void AddSides(const Panel& panel, int left, int bottom, int width, int height, vtkRenderer& renderer) {
  constexpr int kInside = 5 * Canvas::kSampling, kLetter = 9 * Canvas::kSampling;
  const int x = left + (width - kLetter) / 2, y = bottom + (height - kLetter) / 2;
  AddMark(panel.sides[0], left + kInside, y, 13, true, renderer, kSideInk);
  AddMark(panel.sides[1], left + width - kInside - kLetter, y, 13, true, renderer, kSideInk);
  AddMark(panel.sides[2], x, bottom + kInside, 13, true, renderer, kSideInk);
  AddMark(panel.sides[3], x, bottom + height - kInside - kLetter - kInside, 13, true, renderer, kSideInk);
}

// Rows of panels, each as high as its highest panel, filled from the left.
struct Arrangement {
  std::vector<std::size_t> in_row;  // number of panels
  double scale = 0;                 // pixels drawn a metre
  int height = 0;                   // of all rows with their captions [pixel drawn]
};

// The rows in which the panels are drawn largest.
Arrangement Arrange(const SlicesInput& input, const std::vector<Panel>& panels, int width, int height) {
  Arrangement best;
  double heights = 0;  // of all rows [m]
  const auto row_scale = [&](const std::vector<std::size_t>& in_row) {
    double scale = 1e30;
    heights = 0;
    std::size_t p = 0;
    for (const std::size_t count : in_row) {
      double widths = 0, highest = 0;
      for (std::size_t i = 0; i < count; ++i, ++p) {
        const Slice slice(input, panels[p]);
        widths += slice.width();
        highest = std::max(highest, slice.height());
      }
      heights += highest;
      scale = std::min(scale, (width - static_cast<int>(count + 1) * kMargin) / widths);
    }
    const int rows = static_cast<int>(in_row.size());
    return std::min(scale, (height - rows * (kMargin + kCaption)) / heights);
  };
  for (const std::vector<std::size_t>& in_row :
       std::vector<std::vector<std::size_t>>{{6}, {4, 2}, {3, 3}, {2, 2, 2}, {1, 1, 1, 1, 1, 1}, {5, 1}, {2, 4}}) {
    const double scale = row_scale(in_row);
    if (scale <= best.scale * 1.001) continue;
    best = {in_row, scale,
            static_cast<int>(heights * scale + static_cast<double>(in_row.size()) * (kMargin + kCaption))};
  }
  return best;
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
  const std::vector<Panel> panels = ChoosePanels(input);
  const Arrangement arrangement =
      Arrange(input, panels, size.width * Canvas::kSampling, size.height * Canvas::kSampling - kHead - kFoot);
  const int needed = (arrangement.height + kHead + kFoot) / Canvas::kSampling + 1;
  size.height = std::clamp(needed, 16, std::max(16, size.height));
  Canvas canvas(size);
  const double scale = arrangement.scale;
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
  const auto grey = GreyRange(input);
  int top = canvas.height() - kHead - kCaption;
  std::size_t p = 0;
  for (const std::size_t count : arrangement.in_row) {
    double widths = 0;
    int highest = 0;
    for (std::size_t i = p; i < p + count; ++i) widths += Slice(input, panels[i]).width() * scale;
    // What a row does not need is space between its panels.
    const int gap = std::max(kMargin, static_cast<int>((canvas.width() - widths) / static_cast<double>(count + 1)));
    int left = gap;
    for (std::size_t i = 0; i < count; ++i, ++p) {
      const Slice slice(input, panels[p]);
      const int width = static_cast<int>(slice.width() * scale), height = static_cast<int>(slice.height() * scale);
      Paint(slice, scale, left, top - height, grey, raster);
      const std::string caption = std::string(1, "ijk"[panels[p].across]) + " = " + std::to_string(panels[p].at);
      AddMark(caption, left, top + 5 * Canvas::kSampling, 13, false, *renderer);
      AddSides(panels[p], left, top - height, width, height, *renderer);
      left += width + gap;
      highest = std::max(highest, height);
    }
    top -= highest + kMargin + kCaption;
  }
  AddMark(input.title, 2 * kMargin, canvas.height() - kHead + 8 * Canvas::kSampling, 17, true, *renderer);
  AddFoot(input, scale, canvas.width(), raster, *renderer);
  canvas.Save(path);
}

}  // namespace fascicle::client
