# Writes a C++ source with the bytes of a file: cmake -DINPUT=set.bin -DOUTPUT=set.cc -DSYMBOL=Name -P embed.cmake
file(READ ${INPUT} hex HEX)
string(LENGTH "${hex}" digits)
math(EXPR size "${digits} / 2")
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${hex}")
file(WRITE ${OUTPUT}.new "// Made by embed.cmake.
#include <cstddef>
#include <string_view>

namespace fascicle {
namespace {
const unsigned char kBytes[] = {${bytes}};
}

std::string_view ${SYMBOL}();
std::string_view ${SYMBOL}() { return {reinterpret_cast<const char*>(kBytes), ${size}}; }

}  // namespace fascicle
")
file(RENAME ${OUTPUT}.new ${OUTPUT})
