#ifndef FASCICLE_TESTS_CLIENT_COMMANDS_COMMAND_LINES_H_
#define FASCICLE_TESTS_CLIENT_COMMANDS_COMMAND_LINES_H_

#include <string>
#include <string_view>
#include <vector>

namespace fascicle::testing {

// A command line that a document shows.
struct CommandLine {
  int line = 0;         // of the document, from 1
  std::string command;  // continued lines are joined, the comment is removed
  std::string comment;
  int section = 0;  // the number of headings before it
};

// The lines of a README: fenced code without a language, and indented code that begins with a program.
std::vector<CommandLine> LinesOfReadme(std::string_view text);

// The lines of the examples and first steps of a `--help`, whose comments are two or more blanks apart.
std::vector<CommandLine> LinesOfHelp(std::string_view text);

// The sub-commands that a `--help` lists.
std::vector<std::string> SubcommandsOf(std::string_view text);

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_CLIENT_COMMANDS_COMMAND_LINES_H_
