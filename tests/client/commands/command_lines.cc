#include "command_lines.h"

#include <algorithm>
#include <array>
#include <sstream>

namespace fascicle::testing {
namespace {

constexpr std::size_t kIndentation = 4;  // of indented code

std::vector<std::string> SplitLines(std::string_view text) {
  std::vector<std::string> lines;
  std::istringstream in{std::string(text)};
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::string Trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(' ');
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(' ') - first + 1);
}

// Whether a line begins with a program, and not with a formula or a part of a drawing.
bool BeginsWithProgram(const std::string& line) {
  constexpr std::array kPrograms = {"fascicle ", "fascicled", "deploy/", "build/", "ctest ", "source ",
                                    "cmake ",    "ssh ",      "git ",    "curl ",  "sudo ",  "systemctl "};
  const std::string text = Trimmed(line);
  return text == "fascicle" || std::any_of(kPrograms.begin(), kPrograms.end(),
                                           [&](const char* program) { return text.starts_with(program); });
}

// Where the comment of a line begins: at `mark` outside of quotes; the end of the line if there is none.
std::size_t CommentOf(const std::string& line, std::string_view mark) {
  char quote = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (quote != 0) {
      if (line[i] == quote) quote = 0;
    } else if (line.compare(i, mark.size(), mark) == 0) {
      return i;
    } else if (line[i] == '\'' || line[i] == '"') {
      quote = line[i];
    }
  }
  return line.size();
}

// Reads a command from lines[at] on; `at` is then its last line.
CommandLine ReadCommand(const std::vector<std::string>& lines, std::size_t& at, std::string_view mark) {
  CommandLine command;
  command.line = static_cast<int>(at) + 1;
  for (;; ++at) {
    const std::string line = Trimmed(lines[at]);
    const std::size_t comment = CommentOf(line, mark);
    command.command += Trimmed(line.substr(0, comment));
    if (comment < line.size()) command.comment = Trimmed(line.substr(comment + mark.size()));
    if (!command.command.ends_with('\\') || at + 1 == lines.size()) return command;
    command.command.pop_back();
  }
}

}  // namespace

std::vector<CommandLine> LinesOfReadme(std::string_view text) {
  const std::vector<std::string> lines = SplitLines(text);
  std::vector<CommandLine> commands;
  bool fenced = false, commands_in_fence = false, indented = false;
  int section = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string line = Trimmed(lines[i]);
    if (line.starts_with("```")) {
      fenced = !fenced;
      const std::string language = line.substr(3);
      commands_in_fence = fenced && (language.empty() || language == "sh" || language == "bash");
      continue;
    }
    // Code is indented after an empty line only; in a list it may be part of a paragraph.
    const bool deep = lines[i].find_first_not_of(' ') >= kIndentation;
    indented = !fenced && !line.empty() && deep && (indented || i == 0 || Trimmed(lines[i - 1]).empty());
    if (!fenced && line.starts_with("#")) ++section;
    if (line.empty() || line.starts_with("#")) continue;
    if ((fenced && commands_in_fence) || (indented && BeginsWithProgram(line))) {
      commands.push_back(ReadCommand(lines, i, " #"));
      commands.back().section = section;
    }
  }
  return commands;
}

std::vector<CommandLine> LinesOfHelp(std::string_view text) {
  const std::vector<std::string> lines = SplitLines(text);
  std::vector<CommandLine> commands;
  bool inside = false;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    inside = inside || lines[i] == "Examples:" || lines[i] == "First steps:";
    const bool is_example = lines[i].starts_with("  ") && !lines[i].starts_with("   ");
    if (inside && is_example && BeginsWithProgram(lines[i])) commands.push_back(ReadCommand(lines, i, "  "));
  }
  return commands;
}

std::vector<std::string> SubcommandsOf(std::string_view text) {
  std::vector<std::string> names;
  bool inside = false;
  for (const std::string& line : SplitLines(text)) {
    if (line.empty()) inside = false;
    if (inside && line.starts_with("  ") && line[2] != ' ') names.push_back(line.substr(2, line.find(' ', 2) - 2));
    if (line == "Subcommands:") inside = true;
  }
  return names;
}

}  // namespace fascicle::testing
