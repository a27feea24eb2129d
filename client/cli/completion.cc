#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <CLI/App.hpp>

#include "client/cli/command.h"

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
};

void Collect(const CLI::App& app, const std::string& chain, std::vector<Node>& nodes) {
  Node node{chain, {}, {}};
  for (const CLI::Option* option : app.get_options()) {
    if (option->nonpositional()) node.options.push_back(option);
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
  std::cout << R"text(_fascicle() {
  local current=${COMP_WORDS[COMP_CWORD]}
  local chain
  chain=$(_fascicle_chain "${COMP_WORDS[@]:1:COMP_CWORD-1}")
  COMPREPLY=($(compgen -W "$(_fascicle_words "$chain")" -- "$current"))
}
complete -o default -F _fascicle fascicle
)text";
}

void PrintZsh(const std::vector<Node>& nodes) {
  std::cout << "#compdef fascicle\n";
  PrintWords(nodes);
  std::cout << R"text(_fascicle() {
  local chain
  chain=$(_fascicle_chain "${(@)words[2,CURRENT-1]}")
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
      if (option->get_items_expected_max() > 0) std::cout << " -r";
      std::cout << " -d " << Quoted(option->get_description()) << '\n';
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
