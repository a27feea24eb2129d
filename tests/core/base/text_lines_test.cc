#include "core/base/text_lines.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <utility>

namespace fascicle {
namespace {

using ::testing::ElementsAre;

std::vector<std::pair<std::size_t, std::string_view>> LinesOf(std::string_view text) {
  std::vector<std::pair<std::size_t, std::string_view>> lines;
  for (TextLines reader(text); reader.Next();) lines.push_back({reader.number(), reader.line()});
  return lines;
}

TEST(TextLines, SkipsWhatIsEmptyAndCountsIt) {
  using Line = std::pair<std::size_t, std::string_view>;
  EXPECT_THAT(LinesOf("a b\n\n  # only a comment\r\n\tc # d\r\ne"),
              ElementsAre(Line(1, "a b"), Line(4, "c"), Line(5, "e")));
  EXPECT_THAT(LinesOf(""), ElementsAre());
  EXPECT_THAT(LinesOf("\n#\n \n"), ElementsAre());
}

TEST(TextLines, WordsStandBetweenBlanks) {
  EXPECT_THAT(Words(" c1\tc2   bulk "), ElementsAre("c1", "c2", "bulk"));
  EXPECT_THAT(Words(" \t "), ElementsAre());
}

TEST(TextLines, NumbersAreExactlyAsManyAndFinite) {
  std::array<double, 3> values = {};
  EXPECT_TRUE(ParseNumbers("1 -2.5e-3\t+4", values));
  EXPECT_THAT(values, ElementsAre(1, -2.5e-3, 4));
  for (const char* line :
       {"", "1 2", "1 2 3 4", "1 2 x", "1 2 3x", "1 2 nan", "1 inf 3", "1,2,3", "1 2 +-3", "1 2 1e999"}) {
    EXPECT_FALSE(ParseNumbers(line, values)) << line;
  }
}

}  // namespace
}  // namespace fascicle
