// In place of a program whose rows all compare with a library that is not installed.
#include <cstdio>

int main() { std::printf("left out: %s\n", LEFT_OUT); }
