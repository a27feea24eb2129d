#include <iostream>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <CLI/App.hpp>

#include "client/cli/builtin_examples.h"
#include "client/cli/command.h"
#include "core/materials/material.h"

namespace fascicle::client {
namespace {

constexpr const char* kCompletionExamples =
    R"text(  source <(fascicle completion bash)                                    this shell
  fascicle completion bash > ~/.local/share/bash-completion/completions/fascicle
  fascicle completion zsh > "${fpath[1]}/_fascicle"
  fascicle completion fish > ~/.config/fish/completions/fascicle.fish
)text";

// The words that may follow a chain of sub-commands.
struct Node {
  std::string chain;  // "", "materials", "materials curve"
  std::vector<const CLI::App*> commands;
  std::vector<const CLI::Option*> options;
  std::vector<const CLI::Option*> arguments;
};

void Collect(const CLI::App& app, const std::string& chain, std::vector<Node>& nodes) {
  Node node{chain, {}, {}, {}};
  for (const CLI::Option* option : app.get_options()) {
    (option->nonpositional() ? node.options : node.arguments).push_back(option);
  }
  const auto commands = app.get_subcommands([](const CLI::App*) { return true; });
  node.commands.assign(commands.begin(), commands.end());
  nodes.push_back(node);
  for (const CLI::App* command : commands) {
    Collect(*command, chain.empty() ? command->get_name() : chain + " " + command->get_name(), nodes);
  }
}

std::vector<std::string> Flags(const CLI::Option& option) {
  std::vector<std::string> flags;
  for (const std::string& name : option.get_lnames()) flags.push_back("--" + name);
  for (const std::string& name : option.get_snames()) flags.push_back("-" + name);
  return flags;
}

std::string WordsOf(const Node& node, const Node& global) {
  std::string words;
  for (const CLI::App* command : node.commands) words += command->get_name() + " ";
  for (const Node* part : {&node, &global}) {
    for (const CLI::Option* option : part->options) {
      for (const std::string& flag : Flags(*option)) {
        if ((" " + words).find(" " + flag + " ") == std::string::npos) words += flag + " ";
      }
    }
    if (&node == &global) break;
  }
  if (!words.empty()) words.pop_back();
  return words;
}

// The values of a closed list, which CLI11 tells in braces: "TEXT:{front,back}".
std::vector<std::string> ListedValues(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t open = type.find('{'), close = type.find('}');
  if (open == std::string::npos || close == std::string::npos) return {};
  std::vector<std::string> values;
  std::istringstream list(type.substr(open + 1, close - open - 1));
  for (std::string value; std::getline(list, value, ',');) values.push_back(value);
  return values;
}

constexpr const char* kAskedJobs = "@jobs";  // asked from the server while completing

// What may stand for an option or an argument; empty: files.
std::vector<std::string> ValuesOf(const std::string& chain, const CLI::Option& option) {
  if (std::vector<std::string> listed = ListedValues(option); !listed.empty()) return listed;
  if (option.nonpositional()) return {};
  const std::string name = option.get_name(true);
  std::vector<std::string> values;
  if (name == "JOB") return {kAskedJobs};
  if (name == "LAW") {
    for (const LawInfo& law : Laws()) values.emplace_back(law.name);
  } else if (chain.starts_with("examples ")) {
    for (const BuiltinFile& file : BuiltinExamples()) {
      if (file.name.ends_with(".json")) values.emplace_back(file.name.substr(0, file.name.size() - 5));
    }
  }
  return values;
}

std::string Joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

// Prints a function `_fascicle_values CHAIN WORD` that prints the values of an option, or those of the arguments of a
// command where WORD is empty; it fails where there is no list.
void PrintValues(const std::vector<Node>& nodes) {
  std::cout << "_fascicle_values() {\n  case \"$1 $2\" in\n";
  for (const Node& node : nodes) {
    for (const CLI::Option* option : node.options) {
      const std::vector<std::string> values = ValuesOf(node.chain, *option);
      if (values.empty()) continue;
      std::string names;
      for (const std::string& flag : Flags(*option)) {
        names += (names.empty() ? "'" : "|'") + node.chain + " " + flag + "'";
      }
      std::cout << "    " << names << ") echo '" << Joined(values) << "' ;;\n";
    }
    for (const CLI::Option* argument : node.arguments) {
      const std::vector<std::string> values = ValuesOf(node.chain, *argument);
      if (values.empty()) continue;
      std::cout << "    '" << node.chain << " ') ";
      if (values[0] == kAskedJobs) {
        std::cout << "_fascicle_jobs ;;\n";
      } else {
        std::cout << "echo '" << Joined(values) << "' ;;\n";
      }
    }
  }
  std::cout << "    *) return 1 ;;\n  esac\n}\n"
               "# The newest jobs of the server, if it answers soon.\n"
               "_fascicle_jobs() {\n"
               "  timeout 2 fascicle list --json 2>/dev/null | sed -n 's/^{\"job\":\"\\([^\"]*\\)\".*/\\1/p'\n}\n";
}

// Prints a function `_fascicle_words CHAIN` that prints the words that may follow, for bash and zsh.
void PrintWords(const std::vector<Node>& nodes) {
  std::cout << "_fascicle_words() {\n  case \"$1\" in\n";
  for (const Node& node : nodes)
    std::cout << "    '" << node.chain << "') echo '" << WordsOf(node, nodes[0]) << "' ;;\n";
  std::cout << "    *) return 1 ;;\n  esac\n}\n"
               "# The longest chain of sub-commands among the given words.\n"
               "_fascicle_chain() {\n  local chain= word\n  for word in \"$@\"; do\n"
               "    if [ -n \"$chain\" ] && _fascicle_words \"$chain $word\" >/dev/null; then chain=\"$chain $word\"\n"
               "    elif [ -z \"$chain\" ] && _fascicle_words \"$word\" >/dev/null; then chain=$word\n"
               "    fi\n  done\n  echo \"$chain\"\n}\n";
}

void PrintBash(const std::vector<Node>& nodes) {
  PrintWords(nodes);
  PrintValues(nodes);
  std::cout << R"text(_fascicle() {
  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]}
  local chain values
  chain=$(_fascicle_chain "${COMP_WORDS[@]:1:COMP_CWORD-1}")
  if [[ $previous == -* ]] && values=$(_fascicle_values "$chain" "$previous"); then
    COMPREPLY=($(compgen -W "$values" -- "$current"))
    return
  fi
  if [[ $current != -* ]] && values=$(_fascicle_values "$chain" ""); then
    COMPREPLY=($(compgen -W "$values $(_fascicle_words "$chain")" -- "$current") $(compgen -d -- "$current"))
    return
  fi
  COMPREPLY=($(compgen -W "$(_fascicle_words "$chain")" -- "$current"))
}
complete -o default -F _fascicle fascicle
)text";
}

void PrintZsh(const std::vector<Node>& nodes) {
  std::cout << "#compdef fascicle\n";
  PrintWords(nodes);
  PrintValues(nodes);
  std::cout << R"text(_fascicle() {
  local chain values previous=${words[CURRENT-1]}
  chain=$(_fascicle_chain "${(@)words[2,CURRENT-1]}")
  if [[ $previous == -* ]] && values=$(_fascicle_values "$chain" "$previous"); then
    compadd -- ${=values}
    return
  fi
  if values=$(_fascicle_values "$chain" ""); then compadd -- ${=values}; fi
  compadd -- ${=$(_fascicle_words "$chain")}
  _files
}
if [ "$funcstack[1]" = _fascicle ]; then _fascicle "$@"; else compdef _fascicle fascicle; fi
)text";
}

std::string Quoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' || c == '\\' ? std::string("\\") + c : std::string(1, c);
  return quoted + "'";
}

constexpr const char* kJobsOfFish =
    "(timeout 2 fascicle list --json 2>/dev/null | string replace -rf '^\\{\"job\":\"([^\"]*)\".*' '$1')";

void PrintFish(const std::vector<Node>& nodes) {
  for (const Node& node : nodes) {
    std::string condition = "__fish_use_subcommand";
    if (!node.chain.empty()) {
      condition.clear();
      std::size_t start = 0;
      while (start <= node.chain.size()) {
        const std::size_t end = std::min(node.chain.find(' ', start), node.chain.size());
        condition += (condition.empty() ? "" : "; and ") +
                     ("__fish_seen_subcommand_from " + node.chain.substr(start, end - start));
        start = end + 1;
      }
    }
    for (const CLI::App* command : node.commands) {
      std::cout << "complete -c fascicle -n " << Quoted(condition) << " -a " << command->get_name() << " -d "
                << Quoted(command->get_description()) << '\n';
    }
    for (const CLI::Option* option : node.options) {
      std::cout << "complete -c fascicle";
      if (!node.chain.empty()) std::cout << " -n " << Quoted(condition);
      for (const std::string& name : option->get_lnames()) std::cout << " -l " << name;
      for (const std::string& name : option->get_snames()) std::cout << " -s " << name;
      const std::vector<std::string> values = ValuesOf(node.chain, *option);
      if (!values.empty()) {
        std::cout << " -xa " << Quoted(Joined(values));
      } else if (option->get_items_expected_max() > 0) {
        std::cout << " -r";
      }
      std::cout << " -d " << Quoted(option->get_description()) << '\n';
    }
    for (const CLI::Option* argument : node.arguments) {
      const std::vector<std::string> values = ValuesOf(node.chain, *argument);
      if (values.empty()) continue;
      const std::string words = values[0] == kAskedJobs ? kJobsOfFish : Joined(values);
      std::cout << "complete -c fascicle -n " << Quoted(condition) << " -a " << Quoted(words) << '\n';
    }
  }
}

}  // namespace

void AddCompletion(CLI::App& app, Context& context) {
  CLI::App* command = AddCommand(app, "completion", "Print a completion script for a shell", kCompletionExamples);
  const auto shell = std::make_shared<std::string>();
  command->add_option("SHELL", *shell, "bash, zsh or fish")->required()->check(CLI::IsMember({"bash", "zsh", "fish"}));
  command->callback([shell, &app, &context] {
    context.action = [shell, &app] {
      std::vector<Node> nodes;
      Collect(app, "", nodes);
      if (*shell == "bash") PrintBash(nodes);
      if (*shell == "zsh") PrintZsh(nodes);
      if (*shell == "fish") PrintFish(nodes);
      return static_cast<int>(kDone);
    };
  });
}

}  // namespace fascicle::client
