#include <charconv>
#include <cstdio>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>

#include "client/cli/command.h"
#include "client/cli/job_source.h"

namespace fascicle::client {
namespace {

constexpr const char* kSteerExamples =
    R"(  fascicle steer jobs/3f2a activation=muscle:0.7            from the next step on
  fascicle steer 3f2a activation=muscle:0.2 --ramp 0        at once, not over a frame interval
  fascicle steer 3f2a load=muscle/tip:2 motion=muscle/insertion:0.5 --at 60
  fascicle steer 3f2a load=gravity:0 --at-step 500000
  fascicle steer 3f2a --list                                its inputs, and what can be changed

An activation replaces that of the scene; loads and motions of supports are multiplied by a factor. An input
is stored before it is answered. `fascicle replay` runs the job again with the same inputs.
)";

struct SteerArguments {
  std::string job;
  std::vector<std::string> changes;
  double at = -1, ramp = -1;  // [s]; negative: not given
  std::int64_t at_step = 0, sequence = 0;
  bool list = false;
};

// `activation=biceps:0.7` as a control of the input. The path of the control leads back to the argument.
void AddChange(const std::string& argument, v1::SteeringChanges& changes, std::map<std::string, std::string>& arguments,
               Problems& problems) {
  const std::size_t equals = argument.find('='), colon = argument.rfind(':');
  const std::string kind = argument.substr(0, equals);
  const std::map<std::string, google::protobuf::RepeatedPtrField<v1::SteeredControl>*> lists = {
      {"activation", changes.mutable_activations()},
      {"load", changes.mutable_loads()},
      {"motion", changes.mutable_motions()}};
  const auto list = lists.find(kind);
  if (list == lists.end()) {
    problems.Add(argument, "does not begin with activation=, load= or motion=", "such as activation=muscle:0.7");
    return;
  }
  double value = 0;
  const char* end = argument.data() + argument.size();
  const bool has_value = colon != std::string::npos && colon > equals + 1;
  const auto [rest, error] =
      has_value ? std::from_chars(argument.data() + colon + 1, end, value) : std::from_chars_result{end, std::errc()};
  if (!has_value || error != std::errc() || rest != end || colon + 1 == argument.size()) {
    problems.Add(argument, "must be " + kind + "=NAME:NUMBER", "such as " + kind + "=muscle:0.7");
    return;
  }
  arguments["input.changes." + kind + "s[" + std::to_string(list->second->size()) + "]"] = argument;
  v1::SteeredControl& control = *list->second->Add();
  control.set_name(argument.substr(equals + 1, colon - equals - 1));
  control.set_value(value);
}

// The same error with the words of the command line in place of field paths.
Error InArguments(const Error& error, const std::map<std::string, std::string>& arguments) {
  Error result = error;
  result.problems = {};
  for (Problem problem : error.problems.kept()) {
    const std::size_t bracket = problem.path.find(']');
    const auto found = arguments.find(problem.path.substr(0, bracket == std::string::npos ? bracket : bracket + 1));
    if (found != arguments.end()) {
      problem.path = found->second;
    } else if (problem.path == "input.at_step") {
      problem.path = "--at-step";
    } else if (problem.path == "input.at_time") {
      problem.path = "--at";
    } else if (problem.path == "input.changes.ramp") {
      problem.path = "--ramp";
    } else if (problem.path == "input.sequence") {
      problem.path = "--sequence";
    }
    result.problems.Add(std::move(problem.path), std::move(problem.message), std::move(problem.hint));
  }
  return result;
}

Json JsonOf(const v1::SteeringInput& input) {
  Json json = {{"sequence", input.sequence()}};
  if (input.has_step()) json["step"] = input.step();
  if (input.has_at_time()) json["at_time"] = input.at_time();
  json["applied"] = input.applied();
  json["ramp"] = input.changes().ramp();
  const auto put = [&](const char* name, const auto& controls) {
    for (const v1::SteeredControl& control : controls) json[name][control.name()] = control.value();
  };
  put("activations", input.changes().activations());
  put("loads", input.changes().loads());
  put("motions", input.changes().motions());
  return json;
}

std::string WhenText(const v1::SteeringInput& input) {
  if (input.has_step()) return "with step " + std::to_string(input.step());
  char text[64];
  std::snprintf(text, sizeof text, "with the first step from t = %.6g s on", input.at_time());
  return text;
}

std::string ChangesText(const v1::SteeringChanges& changes) {
  std::string text;
  const auto put = [&](const char* kind, const auto& controls) {
    for (const v1::SteeredControl& control : controls) {
      char value[32];
      std::snprintf(value, sizeof value, ":%.6g ", control.value());
      text += kind + ("=" + control.name()) + value;
    }
  };
  put("activation", changes.activations());
  put("load", changes.loads());
  put("motion", changes.motions());
  char ramp[32];
  std::snprintf(ramp, sizeof ramp, "over %.6g s", changes.ramp());
  return text + (changes.ramp() > 0 ? ramp : "at once");
}

void PrintNames(const char* kind, const google::protobuf::RepeatedPtrField<std::string>& names) {
  for (const std::string& name : names) std::cout << "  " << kind << '=' << name << ":VALUE\n";
}

int ListInputs(const std::string& given, const Context& context) {
  JobSource source = OpenJob(context, given);
  const v1::ListSteeringResponse list = Take(source.client.ListSteering(source.job));
  if (context.json) {
    for (const v1::SteeringInput& input : list.inputs()) PrintJson(JsonOf(input));
    return kDone;
  }
  for (const v1::SteeringInput& input : list.inputs()) {
    std::cout << "input " << input.sequence() << ' ' << WhenText(input) << (input.applied() ? "" : " (not reached yet)")
              << ": " << ChangesText(input.changes()) << '\n';
  }
  std::cout << source.job << (list.inputs_size() == 0 ? " has no inputs. It can be" : " can be") << " steered by\n";
  PrintNames("activation", list.activations());
  PrintNames("load", list.loads());
  PrintNames("motion", list.motions());
  return kDone;
}

// Sends an input with the next free number, or the given one.
v1::SteeringInput Apply(Client& client, const std::string& job, v1::SteeringInput input,
                        const std::map<std::string, std::string>& arguments) {
  constexpr int kAttempts = 5;  // other clients may take the number
  const bool is_numbered = input.sequence() != 0;
  for (int attempt = 1;; ++attempt) {
    if (!is_numbered) input.set_sequence(Take(client.ListSteering(job)).next_sequence());
    Result<v1::SteeringInput> answer = client.ApplySteering(job, input);
    if (answer.ok()) return std::move(answer.value());
    if (is_numbered || answer.error().reason != "SEQUENCE_REUSED" || attempt == kAttempts) {
      throw CommandError(InArguments(answer.error(), arguments));
    }
  }
}

int Steer(const SteerArguments& arguments, const Context& context) {
  if (arguments.list) return ListInputs(arguments.job, context);
  v1::SteeringInput input;
  std::map<std::string, std::string> of_path;
  Problems problems;
  for (const std::string& change : arguments.changes) {
    AddChange(change, *input.mutable_changes(), of_path, problems);
  }
  if (!problems.empty()) throw CommandError({Error::Kind::kInvalid, "the input is invalid", "", problems});
  if (arguments.ramp >= 0) input.mutable_changes()->set_ramp(arguments.ramp);
  if (arguments.at >= 0) input.set_at_time(arguments.at);
  if (arguments.at_step > 0) input.set_at_step(arguments.at_step);
  input.set_sequence(arguments.sequence);
  Client client = Connect(context);
  const std::string job = FindJob(client, arguments.job);
  const v1::SteeringInput applied = Apply(client, job, std::move(input), of_path);
  if (context.json) {
    Json json = {{"job", job}};
    json.update(JsonOf(applied));
    PrintJson(json);
  } else {
    std::cout << job << "  input " << applied.sequence() << " takes effect " << WhenText(applied) << '\n';
  }
  return kDone;
}

}  // namespace

void AddSteer(CLI::App& app, Context& context) {
  CLI::App* command =
      AddCommand(app, "steer", "Change activations, loads and motions of a running job", kSteerExamples);
  const auto arguments = std::make_shared<SteerArguments>();
  command->add_option("JOB", arguments->job, "The job")->required();
  CLI::Option* changes = command->add_option("CHANGE", arguments->changes,
                                             "activation=NAME:VALUE, load=NAME:FACTOR or motion=NAME:FACTOR");
  CLI::Option* at = command->add_option("--at", arguments->at, "Take effect at this time")
                        ->type_name("SECONDS")
                        ->check(CLI::NonNegativeNumber);
  command->add_option("--at-step", arguments->at_step, "Take effect with this step; they are counted from 1")
      ->check(CLI::PositiveNumber)
      ->excludes(at);
  command->add_option("--ramp", arguments->ramp, "Go to the new values over this time; by default the frame interval")
      ->type_name("SECONDS")
      ->check(CLI::NonNegativeNumber);
  command
      ->add_option("--sequence", arguments->sequence,
                   "Number of the input, so that it can be repeated; by default the next one")
      ->check(CLI::PositiveNumber);
  CLI::Option* list =
      command->add_flag("--list", arguments->list, "List the inputs of the job and what can be changed");
  list->excludes(changes);
  command->callback([arguments, &context] {
    if (arguments->changes.empty() && !arguments->list) throw CLI::RequiredError("CHANGE or --list");
    context.action = [arguments, &context] { return Steer(*arguments, context); };
  });
}

}  // namespace fascicle::client
