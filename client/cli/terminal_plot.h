#ifndef FASCICLE_CLIENT_CLI_TERMINAL_PLOT_H_
#define FASCICLE_CLIENT_CLI_TERMINAL_PLOT_H_

#include <string>

#include "client/render/plot.h"

namespace fascicle::client {

// Draws a panel with Braille characters (2 x 4 dots each), with axes and a legend, each line in its own colour if
// `coloured`. `width` and `height` [character] exclude the labels.
std::string TerminalPlot(const PlotPanel& panel, int width, int height, bool coloured);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_CLI_TERMINAL_PLOT_H_
