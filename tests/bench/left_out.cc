// Replaces a program if the library that all its rows compare with is not installed.
#include <cstdio>

int main() { std::printf("left out: %s\n", LEFT_OUT); }
