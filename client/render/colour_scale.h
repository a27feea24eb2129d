#ifndef FASCICLE_CLIENT_RENDER_COLOUR_SCALE_H_
#define FASCICLE_CLIENT_RENDER_COLOUR_SCALE_H_

#include <vtkLookupTable.h>
#include <vtkSmartPointer.h>

#include <string>

namespace fascicle::client {

// A unit and a factor that make values of a given magnitude easy to read: 0.012 m -> 12 mm.
struct ReadableUnit {
  double factor = 1;  // shown value = factor * value
  std::string name;   // "mm", "kPa"; empty for pure numbers
};
ReadableUnit MakeReadable(double largest, const std::string& unit);

// Colours over [lowest, highest]: dark blue, green, yellow; or blue, white, red around zero if the values clearly have
// both signs.
struct ColourScale {
  double lowest = 0;
  double highest = 1;
  vtkSmartPointer<vtkLookupTable> table;
};
ColourScale MakeColourScale(double lowest, double highest, bool keep_ends);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_RENDER_COLOUR_SCALE_H_
