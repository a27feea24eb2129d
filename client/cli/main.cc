#include "client/cli/command.h"

int main(int argc, char** argv) { return fascicle::client::Main(argc, argv); }
