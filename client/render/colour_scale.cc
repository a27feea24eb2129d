#include "client/render/colour_scale.h"

#include <vtkColorTransferFunction.h>
#include <vtkNew.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace fascicle::client {
namespace {

constexpr int kColours = 256;

// Nearly uniform in perceived lightness, so that equal differences look equal, also in grey and for colour-blind
// readers.
constexpr std::array<std::array<double, 3>, 9> kSequential = {{{0.267, 0.005, 0.329},
                                                               {0.279, 0.175, 0.483},
                                                               {0.230, 0.322, 0.546},
                                                               {0.173, 0.449, 0.558},
                                                               {0.128, 0.567, 0.551},
                                                               {0.158, 0.684, 0.502},
                                                               {0.369, 0.789, 0.383},
                                                               {0.678, 0.864, 0.190},
                                                               {0.993, 0.906, 0.144}}};
constexpr std::array<std::array<double, 3>, 5> kDiverging = {
    {{0.13, 0.25, 0.62}, {0.47, 0.67, 0.87}, {0.96, 0.96, 0.94}, {0.95, 0.60, 0.45}, {0.70, 0.07, 0.15}}};

template <std::size_t n>
vtkSmartPointer<vtkLookupTable> MakeTable(const std::array<std::array<double, 3>, n>& colours) {
  vtkNew<vtkColorTransferFunction> blend;
  blend->SetColorSpaceToLab();
  for (std::size_t i = 0; i < n; ++i) {
    blend->AddRGBPoint(static_cast<double>(i) / (n - 1), colours[i][0], colours[i][1], colours[i][2]);
  }
  auto table = vtkSmartPointer<vtkLookupTable>::New();
  table->SetNumberOfTableValues(kColours);
  for (int i = 0; i < kColours; ++i) {
    double rgb[3];
    blend->GetColor(i / (kColours - 1.0), rgb);
    table->SetTableValue(i, rgb[0], rgb[1], rgb[2]);
  }
  return table;
}

bool TakesPrefix(const std::string& unit) {
  return unit == "m" || unit == "m/s" || unit == "Pa" || unit == "N" || unit == "J";
}

}  // namespace

ReadableUnit MakeReadable(double largest, const std::string& unit) {
  if (unit == "1") return {1, ""};
  if (!TakesPrefix(unit) || !(largest > 0) || !std::isfinite(largest)) return {1, unit};
  struct Prefix {
    double size;
    const char* name;
  };
  constexpr std::array<Prefix, 5> kPrefixes = {{{1e6, "M"}, {1e3, "k"}, {1, ""}, {1e-3, "m"}, {1e-6, "µ"}}};
  for (const Prefix& prefix : kPrefixes) {
    if (prefix.size > 1 && unit[0] == 'm') continue;  // kilometres are never useful here
    if (largest >= prefix.size) return {1 / prefix.size, prefix.name + unit};
  }
  return {1e6, "µ" + unit};
}

std::string SpokenName(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  for (const char* person : {"Mises", "Cauchy", "Green", "Piola", "Kirchhoff", "Lagrange"}) {
    std::string lower = person;
    lower[0] = static_cast<char>(lower[0] - 'A' + 'a');
    for (std::size_t at = name.find(lower); at != std::string::npos; at = name.find(lower, at + 1))
      name[at] = person[0];
  }
  return name;
}

ColourScale MakeCategories(int count) {
  // After the first, distinguishable by colour-blind readers, too [Okabe and Ito].
  constexpr std::array<std::array<double, 3>, 8> kColoursOfParts = {{{0.78, 0.66, 0.62},
                                                                     {0.00, 0.45, 0.70},
                                                                     {0.90, 0.62, 0.00},
                                                                     {0.00, 0.62, 0.45},
                                                                     {0.80, 0.47, 0.65},
                                                                     {0.84, 0.37, 0.00},
                                                                     {0.34, 0.71, 0.91},
                                                                     {0.94, 0.89, 0.26}}};
  ColourScale scale{-0.5, count - 0.5, vtkSmartPointer<vtkLookupTable>::New(), true};
  scale.table->SetNumberOfTableValues(count);
  for (int i = 0; i < count; ++i) {
    // Colours repeat, but for the first one.
    const auto& colour = kColoursOfParts[static_cast<std::size_t>(i == 0 ? 0 : 1 + (i - 1) % 7)];
    scale.table->SetTableValue(i, colour[0], colour[1], colour[2]);
  }
  scale.table->SetRange(scale.lowest, scale.highest);
  return scale;
}

ColourScale MakeColourScale(double lowest, double highest, bool keep_ends) {
  // A uniform field still needs a non-empty range.
  const double size = std::max(std::abs(lowest), std::abs(highest));
  if (!(highest - lowest > 1e-9 * size)) {
    const double half = size > 0 ? 0.01 * size : 1e-6;
    lowest -= half;
    highest += half;
  }
  const bool both_sides = lowest < 0 && highest > 0 && std::min(-lowest, highest) > 0.1 * std::max(-lowest, highest);
  if (both_sides && !keep_ends) {
    highest = std::max(-lowest, highest);
    lowest = -highest;
  }
  ColourScale scale{lowest, highest, both_sides ? MakeTable(kDiverging) : MakeTable(kSequential), false};
  scale.table->SetRange(lowest, highest);
  return scale;
}

}  // namespace fascicle::client
