#include "client/cli/terminal_plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>

namespace fascicle::client {
namespace {

constexpr std::array<int, 7> kColours = {34, 31, 32, 35, 33, 36, 90};  // as ANSI escapes
constexpr int kLabelWidth = 11;

struct Range {
  double low = INFINITY, high = -INFINITY;
  void Add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  // Extends an empty range, for constant lines.
  void Widen() {
    const double size = std::max(std::abs(low), std::abs(high));
    if (high - low > 1e-12 * size) return;
    const double half = size > 0 ? 0.05 * size : 1;
    low -= half;
    high += half;
  }
  double Part(double value) const { return (value - low) / (high - low); }
};

class BrailleCanvas {
 public:
  BrailleCanvas(int width, int height)
      : width_(width),
        height_(height),
        dots_(static_cast<std::size_t>(width * height), 0),
        colours_(dots_.size(), -1) {}

  // x and y from 0 (left, bottom) to 1.
  void Line(double x0, double y0, double x1, double y1, int colour) {
    const double columns = 2 * width_ - 1, rows = 4 * height_ - 1;
    const int steps = 1 + static_cast<int>(std::max(std::abs(x1 - x0) * columns, std::abs(y1 - y0) * rows));
    for (int i = 0; i <= steps; ++i) {
      const double s = static_cast<double>(i) / steps;
      Dot(static_cast<int>(std::lround((x0 + s * (x1 - x0)) * columns)),
          static_cast<int>(std::lround((1 - (y0 + s * (y1 - y0))) * rows)), colour);
    }
  }

  std::string Row(int row, bool coloured) const {
    std::string text;
    int current = -1;
    for (int column = 0; column < width_; ++column) {
      const std::size_t cell = static_cast<std::size_t>(row * width_ + column);
      if (coloured && colours_[cell] != current) {
        current = colours_[cell];
        text += current < 0 ? "\x1b[0m" : Escape(current);
      }
      text += dots_[cell] == 0 ? " " : Braille(dots_[cell]);
    }
    if (coloured && current >= 0) text += "\x1b[0m";
    return text;
  }

  static std::string Escape(int colour) {
    return "\x1b[" + std::to_string(kColours[static_cast<std::size_t>(colour) % kColours.size()]) + "m";
  }

 private:
  void Dot(int x, int y, int colour) {
    if (x < 0 || y < 0 || x >= 2 * width_ || y >= 4 * height_) return;
    // Bits of U+2800 in Unicode's order: the fourth row was added later than the first six dots.
    constexpr std::uint8_t kBits[4][2] = {{0x01, 0x08}, {0x02, 0x10}, {0x04, 0x20}, {0x40, 0x80}};
    const std::size_t cell = static_cast<std::size_t>((y / 4) * width_ + x / 2);
    dots_[cell] |= kBits[y % 4][x % 2];
    colours_[cell] = colour;
  }

  static std::string Braille(std::uint8_t dots) {
    return {static_cast<char>(0xE2), static_cast<char>(0xA0 | (dots >> 6)), static_cast<char>(0x80 | (dots & 0x3F))};
  }

  int width_, height_;
  std::vector<std::uint8_t> dots_;
  std::vector<int> colours_;
};

std::string TickText(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", std::abs(value) < 1e-300 ? 0.0 : value);
  return text;
}

std::string PadLeft(const std::string& text, std::size_t width) {
  return text.size() >= width ? text : std::string(width - text.size(), ' ') + text;
}

}  // namespace

std::string TerminalPlot(const PlotPanel& panel, int width, int height, bool coloured) {
  Range x, y;
  for (const PlotLine& line : panel.lines) {
    for (std::size_t i = 0; i < line.x.size(); ++i) {
      if (!std::isfinite(line.x[i]) || !std::isfinite(line.y[i])) continue;
      x.Add(line.x[i]);
      y.Add(line.y[i]);
    }
  }
  if (x.low > x.high) return panel.y_label + ": no values\n";
  x.Widen();
  y.Widen();
  BrailleCanvas canvas(width, height);
  for (std::size_t l = 0; l < panel.lines.size(); ++l) {
    const PlotLine& line = panel.lines[l];
    for (std::size_t i = 0; i < line.x.size(); ++i) {
      // Draws a line from the previous point; a point without neighbours is a dot.
      const std::size_t from = !line.as_points && i > 0 && std::isfinite(line.y[i - 1]) ? i - 1 : i;
      if (!std::isfinite(line.x[i]) || !std::isfinite(line.y[i])) continue;
      canvas.Line(x.Part(line.x[from]), y.Part(line.y[from]), x.Part(line.x[i]), y.Part(line.y[i]),
                  static_cast<int>(l));
    }
  }
  const bool is_told = panel.title.empty() || panel.y_label.starts_with(panel.title);
  std::string text = (is_told ? "" : panel.title + ": ") + panel.y_label + "\n";
  for (int row = 0; row < height; ++row) {
    const bool labelled = row == 0 || row == height - 1 || row == height / 2;
    const double value = y.high - (y.high - y.low) * row / (height - 1);
    text += PadLeft(labelled ? TickText(value) : "", kLabelWidth) + (labelled ? " ┤" : " │") +
            canvas.Row(row, coloured) + "\n";
  }
  text += std::string(kLabelWidth + 1, ' ') + "└";
  for (int i = 0; i < width; ++i) text += "─";
  const std::string left = TickText(x.low), right = TickText(x.high);
  const std::size_t room = static_cast<std::size_t>(std::max(0, width - static_cast<int>(left.size() + right.size())));
  const std::size_t before = room > panel.x_label.size() ? (room - panel.x_label.size()) / 2 : 1;
  text += "\n" + std::string(kLabelWidth + 2, ' ') + left + std::string(before, ' ') + panel.x_label +
          PadLeft(right, room + right.size() - std::min(room, before + panel.x_label.size())) + "\n";
  for (std::size_t l = 0; l < panel.lines.size(); ++l) {
    text += std::string(kLabelWidth + 2, ' ') + (coloured ? BrailleCanvas::Escape(static_cast<int>(l)) : "") +
            (panel.lines[l].as_points ? "●● " : "━━ ") + (coloured ? "\x1b[0m" : "") + panel.lines[l].name + "\n";
  }
  return text;
}

}  // namespace fascicle::client
