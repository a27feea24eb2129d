#ifndef FASCICLE_CLIENT_CLI_TERMINAL_PLOT_H_
#define FASCICLE_CLIENT_CLI_TERMINAL_PLOT_H_

#include <string>

#include "client/render/plot.h"

namespace fascicle::client {

// A panel drawn with Braille characters (2 x 4 dots each), with axes and a legend; each line in a colour of its own
// when `coloured`. `width` and `height` [character] of the drawing without its labels.
std::string TerminalPlot(const PlotPanel& panel, int width, int height, bool coloured);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_CLI_TERMINAL_PLOT_H_
