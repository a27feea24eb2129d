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

// A name of a field or series as people write it: "von Mises stress" for von_mises_stress.
std::string SpokenName(std::string name);

// Colours over [lowest, highest]: dark blue, green, yellow; or blue, white, red around zero if the values clearly have
// both signs.
struct ColourScale {
  double lowest = 0;
  double highest = 1;
  vtkSmartPointer<vtkLookupTable> table;
  bool is_list = false;  // of categories
};
// A colour of its own for each of the numbers 0 to count - 1; the first is that of flesh.
ColourScale MakeCategories(int count);
ColourScale MakeColourScale(double lowest, double highest, bool keep_ends);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_RENDER_COLOUR_SCALE_H_
