// Every command line of the READMEs and of the examples of `--help`, run as it is written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "command_lines.h"
#include "known_lines.h"
#include "prepared_folder.h"
#include "tests/support/child_process.h"
#include "tests/support/files.h"
#include "tests/support/paths.h"
#include "tests/support/server_process.h"

namespace fascicle::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::Field;
using ::testing::HasSubstr;

// This file is compiled to two programs.
#ifdef COMMANDS_SLOW
constexpr bool kSlow = true;
#else
constexpr bool kSlow = false;
#endif

// A section of a README, or the help of a command.
struct Document {
  std::string name;
  std::vector<CommandLine> lines;
};

std::vector<Document> Readmes() {
  std::vector<Document> documents;
  const fs::path root = ProjectRoot();
  for (auto entry = fs::recursive_directory_iterator(root); entry != fs::end(entry); ++entry) {
    const std::string name = entry->path().filename().string();
    if (entry->is_directory() && (name == "build" || name == "out" || name.starts_with("."))) {
      entry.disable_recursion_pending();
    }
    if (name != "README.md") continue;
    int section = -1;
    for (CommandLine& line : LinesOfReadme(ReadFile(entry->path()))) {
      if (line.section != section) documents.push_back({fs::relative(entry->path(), root).string(), {}});
      section = line.section;
      documents.back().lines.push_back(std::move(line));
    }
  }
  std::stable_sort(documents.begin(), documents.end(),
                   [](const Document& a, const Document& b) { return a.name < b.name; });
  return documents;
}

std::string Help(std::vector<std::string> command) {
  command.front() = Program(command.front());
  command.emplace_back("--help");
  return RunProgram(command).out;
}

// A parent and its sub-commands may show the same lines, which are kept once.
void AddHelp(const std::vector<std::string>& command, std::vector<Document>& documents) {
  const std::string help = Help(command);
  Document document;
  for (const std::string& word : command) document.name += word + " ";
  document.name += "--help";
  for (CommandLine& line : LinesOfHelp(help)) {
    const bool is_known = std::any_of(documents.begin(), documents.end(), [&](const Document& other) {
      return document.name.starts_with(other.name.substr(0, other.name.size() - 6)) &&
             std::any_of(other.lines.begin(), other.lines.end(),
                         [&](const CommandLine& its) { return its.command == line.command; });
    });
    if (!is_known) document.lines.push_back(std::move(line));
  }
  documents.push_back(std::move(document));
  for (const std::string& name : SubcommandsOf(help)) {
    std::vector<std::string> longer = command;
    longer.push_back(name);
    AddHelp(longer, documents);
  }
}

// Asked for once: each is a process.
const std::vector<Document>& Helps() {
  static const std::vector<Document> kDocuments = [] {
    std::vector<Document> documents;
    AddHelp({"fascicle"}, documents);
    AddHelp({"fascicled"}, documents);
    return documents;
  }();
  return kDocuments;
}

const ExcusedLine* ExcuseOf(const std::string& command) {
  const auto found = std::find_if(kExcusedLines.begin(), kExcusedLines.end(),
                                  [&](const ExcusedLine& line) { return command == line.command; });
  return found == kExcusedLines.end() ? nullptr : &*found;
}

bool IsSlow(const CommandLine& line) {
  return std::find(kSlowLines.begin(), kSlowLines.end(), line.command) != kSlowLines.end();
}

std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
  return text;
}

// A folder with all files that the lines read, the job of a run in `out`, and a server with jobs.
class CommandsTest : public ::testing::Test {
 protected:
  struct Prepared {
    TemporaryFolder folder;
    fs::path files = folder.path() / "files";  // copied for each document
    std::unique_ptr<ServerProcess> server;
    std::string address;
    std::string job, other;  // jobs/ID
    std::string steered;     // the last one
  };

  static void SetUpTestSuite() {
    prepared_ = std::make_unique<Prepared>();
    Prepared& all = *prepared_;
    fs::create_directories(all.files);
    WriteInputs(all.files);
    WriteFile(all.folder / "quick.json", QuickScene());
    WriteFile(all.folder / "endless.json", EndlessScene());
    WriteFile(all.folder / "steered.json", SteeredScene());
    all.server = std::make_unique<ServerProcess>(
        std::vector<std::string>{"--listen", "127.0.0.1:0", "--data", all.folder / "server", "--log-level", "off"});
    all.address = all.server->AwaitAddress();
    ASSERT_NE(all.address, "");
    MakeMore(all.files);
    all.job = Submit("files/scene.json");
    all.other = Submit("files/scene.json");
    for (const std::string& job : {all.job, all.other}) MustRun("fascicle watch " + job, all.files);
  }
  static void TearDownTestSuite() { prepared_.reset(); }

  // Files that `fascicle` itself makes.
  static void MakeMore(const fs::path& files) {
    MustRun("fascicle phantom arm.mha --truth truth.mha", files);
    MustRun("fascicle phantom thigh.nii.gz", files);
    MustRun("fascicle segment labels.mha --label 1 --label 2 --keep all --out labels.nii.gz", files);
    MustRun("fascicle segment labels.mha --label 1 --out anconeus.mha", files);
    MustRun("fascicle run scene.json --out out", files);
  }

  // Runs a line in a folder as a user's shell would.
  static Finished Shell(const std::string& line, const fs::path& folder) {
    const std::string path = fs::path(Program("fascicle")).parent_path().string() + ":" + std::getenv("PATH");
    fs::create_directories(folder / "home");
    const std::string script = "set -o pipefail; cd '" + folder.string() + "' && " + line;
    return RunProgram({"/bin/bash", "-c", script}, {{"PATH", path},
                                                    {"FASCICLE_SERVER", prepared_->address},
                                                    {"FASCICLE_DATA", folder.string()},
                                                    {"HOME", (folder / "home").string()},
                                                    {"DISPLAY", ""}});
  }
  static std::string MustRun(const std::string& line, const fs::path& folder) {
    const Finished finished = Shell(line, folder);
    EXPECT_EQ(finished.exit_code, 0) << line << '\n' << finished.out << finished.err;
    return finished.out;
  }
  static std::string Submit(const std::string& scene) {
    const std::string name = MustRun("fascicle submit " + scene, prepared_->folder.path());
    return name.substr(0, name.find('\n'));
  }

  static bool Steers(const std::string& line) { return line.starts_with("fascicle steer "); }

  // The line with real names in place of the document's.
  static std::string WithNames(std::string line) {
    std::string job = prepared_->job, other = prepared_->other;
    if (line.starts_with("fascicle delete ")) {
      job = Submit("quick.json");
      other = Submit("quick.json");
      for (const std::string& name : {job, other}) MustRun("fascicle watch " + name, prepared_->files);
    }
    if (line.starts_with("fascicle cancel ")) job = Submit("endless.json");
    // Cancelled with its document, and then no job to `log` or `watch`.
    if (line.starts_with("fascicle restart ")) {
      job = Submit("quick.json");
      MustRun("fascicle watch " + job, prepared_->files);
    }
    if (Steers(line)) job = prepared_->steered = Submit("steered.json");
    for (const Placeholder& placeholder : kPlaceholders) line = Replaced(line, placeholder.written, placeholder.meant);
    const auto id = [](const std::string& name) { return name.substr(name.find('/') + 1); };
    line = Replaced(Replaced(line, "$JOB", job), "$OTHER_ID", id(other));
    return Replaced(Replaced(Replaced(line, "$OTHER", other), "$ID", id(job)), "$SERVER", prepared_->address);
  }

  // A line that starts a server must say that it listens, and end by SIGTERM.
  static void RunServer(const std::string& line, const fs::path& folder) {
    ChildProcess server({"/bin/bash", "-c", "cd '" + folder.string() + "' && exec " + Program(line)});
    EXPECT_THAT(server.ReadLine(), HasSubstr("listening on ")) << server.ErrorOutput();
    server.Signal(SIGTERM);
    EXPECT_EQ(server.Wait(std::chrono::seconds(30)), 0);
  }

  // Test programs are not run again: their filters must choose tests. They may not have been built.
  static void ListTests(const std::string& line) {
    const std::string folder = "build/release/tests/bin/";
    const fs::path tests = fs::path(Program("fascicle")).parent_path() / "../tests/bin";
    const std::string name = line.substr(folder.size(), line.find(' ') - folder.size());
    if (!fs::exists(tests / name)) return;
    const std::string here = tests.string() + "/" + line.substr(folder.size());
    EXPECT_THAT(MustRun(here + " --gtest_list_tests", prepared_->files), HasSubstr("\n  "));
  }

  static void RunLine(const CommandLine& line, const fs::path& folder) {
    if (line.command.starts_with("fascicled ")) return RunServer(line.command, folder);
    if (line.command.starts_with("build/release/tests/bin/")) return ListTests(line.command);
    const std::string command = WithNames(line.command);
    const auto start = std::chrono::steady_clock::now();
    const Finished finished = Shell(command, folder);
    EXPECT_EQ(finished.exit_code, 0) << command << '\n' << finished.out << finished.err;
    if (Steers(line.command)) MustRun("fascicle cancel " + prepared_->steered, folder);
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
    if (!kSlow && time.count() > 2) std::printf("%4.1f s  %s\n", time.count(), line.command.c_str());
    // A comment that promises another exit code speaks of a scene that is not valid.
    if (line.comment.find("exit code 2") != std::string::npos) {
      EXPECT_EQ(Shell(Replaced(command, "scene.json", "invalid.json"), folder).exit_code, 2) << command;
    }
  }

  // Runs the lines of a document in a copy of the files, in their order.
  static void RunDocument(const Document& document) {
    const bool has_slow = std::any_of(document.lines.begin(), document.lines.end(), IsSlow);
    if (kSlow && !has_slow) return;
    const fs::path folder = prepared_->folder.path() / "copy";
    fs::copy(prepared_->files, folder, fs::copy_options::recursive);
    for (const CommandLine& line : document.lines) {
      if (ExcuseOf(line.command) != nullptr || (!kSlow && IsSlow(line))) continue;
      SCOPED_TRACE(document.name + ":" + std::to_string(line.line) + ": " + line.command);
      RunLine(line, folder);
    }
    Shell(
        "fascicle list --state running --state queued --json | sed 's/.*\"job\":\"\\([^\"]*\\).*/\\1/' | "
        "while read -r job; do fascicle cancel \"$job\"; done",
        folder);
    fs::remove_all(folder);
  }

  inline static std::unique_ptr<Prepared> prepared_;
};

#ifndef COMMANDS_SLOW
TEST(CommandLinesTest, FencedAndIndentedCodeOfReadmes) {
  const std::vector<CommandLine> lines = LinesOfReadme(R"(Text `fascicle a`.

    fascicle one 'a # b' # comment
    not a program

## Another

```
fascicle two \
  --three   # the end
# a remark
```

```json
{}
```

* A point
    fascicle in a paragraph
)");
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0].command, "fascicle one 'a # b'");
  EXPECT_EQ(lines[0].comment, "comment");
  EXPECT_EQ(lines[0].line, 3);
  EXPECT_EQ(lines[1].command, "fascicle two --three");
  EXPECT_EQ(lines[1].comment, "the end");
  EXPECT_EQ(lines[0].section, 0);
  EXPECT_EQ(lines[1].section, 1);
}

TEST(CommandLinesTest, ExamplesOfHelp) {
  const std::vector<CommandLine> lines = LinesOfHelp(R"(Usage:
  fascicle run [OPTIONS]

Examples:
  fascicle run a  'that' is run
                  and more
  fascicle run a --set 'b  c' \
    --out d       also

Text.
)");
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0].command, "fascicle run a");
  EXPECT_EQ(lines[0].comment, "'that' is run");
  EXPECT_EQ(lines[1].command, "fascicle run a --set 'b  c' --out d");
}

TEST(CommandLinesTest, EachDocumentIsFound) {
  const std::vector<Document> readmes = Readmes(), helps = Helps();
  EXPECT_THAT(readmes, Contains(Field(&Document::name, "README.md")));
  EXPECT_THAT(readmes, Contains(Field(&Document::name, "tests/bench/README.md")));
  EXPECT_THAT(helps, Contains(Field(&Document::name, "fascicle materials curve --help")));
  for (const Document& help : helps) {
    // Sub-commands of `examples` have the lines of their parent.
    if (help.name.starts_with("fascicle examples ") && help.name != "fascicle examples --help") continue;
    EXPECT_FALSE(help.lines.empty()) << help.name;
  }
}

// An excuse, a slow line or a placeholder that no document has is a mistake in the tables.
TEST(CommandLinesTest, EachKnownLineExists) {
  std::set<std::string> commands;
  for (const std::vector<Document>& documents : {Readmes(), Helps()}) {
    for (const Document& document : documents) {
      for (const CommandLine& line : document.lines) commands.insert(line.command);
    }
  }
  for (const ExcusedLine& line : kExcusedLines) EXPECT_TRUE(commands.contains(line.command)) << line.command;
  for (const char* line : kSlowLines) EXPECT_TRUE(commands.contains(line)) << line;
  for (const Placeholder& placeholder : kPlaceholders) {
    EXPECT_TRUE(std::any_of(commands.begin(), commands.end(), [&](const std::string& command) {
      return command.find(placeholder.written) != std::string::npos;
    })) << placeholder.written;
  }
}
#endif

TEST_F(CommandsTest, EveryLineOfTheReadmesRuns) {
  for (const Document& document : Readmes()) RunDocument(document);
}

TEST_F(CommandsTest, EveryExampleOfHelpRuns) {
  for (const Document& document : Helps()) RunDocument(document);
}

}  // namespace
}  // namespace fascicle::testing
