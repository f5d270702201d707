#include "parser.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <type_traits>

#include "lodestone/common/error.h"
#include "lodestone/common/shown.h"
#include "lodestone/common/spelling.h"

namespace lodestone::apps {
namespace {

/// Adds the option to the parser, by the type of its target.
struct Adder {
  CLI::App& app;
  const Option& option;

  CLI::Option* operator()(bool* target) const { return app.add_flag(option.name, *target, option.help); }
  CLI::Option* operator()(const Flag& target) const {
    return app.add_flag_callback(option.name, target.given, option.help);
  }
  CLI::Option* operator()(const Text& target) const {
    return app.set_version_flag(option.name, target.printed, option.help);
  }
  CLI::Option* operator()(const std::function<void(const std::string&)>& target) const {
    if (!option.many) return app.add_option_function(option.name, target, option.help);
    return app.add_option_function<std::vector<std::string>>(
        option.name,
        [target](const std::vector<std::string>& values) {
          for (const std::string& value : values) target(value);
        },
        option.help);
  }
  template <class T>
  CLI::Option* operator()(T* target) const {
    return app.add_option(option.name, *target, option.help);
  }
};

void bind_option(CLI::App& app, const Option& option, bool complete) {
  CLI::Option* made = std::visit(Adder{app, option}, option.target);
  if (!option.value_name.empty()) made->type_name(option.value_name);
  if (option.needed && complete) made->required();
  if (option.many) made->allow_extra_args(false)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  if (option.bounds) {
    const auto [least, most] = *option.bounds;
    if (std::isinf(most))
      made->check(CLI::NonNegativeNumber);
    else if (std::holds_alternative<double*>(option.target))
      made->check(CLI::Range(least, most));
    else
      made->check(CLI::Range(static_cast<std::int64_t>(least), static_cast<std::int64_t>(most)));
  }
  if (!option.choices.empty()) made->check(CLI::IsMember(option.choices));
  if (option.shows_default) made->capture_default_str();
}

/// `complete`: every verb and option that is needed must be there.
void bind(CLI::App& app, const Verb& verb, bool complete) {
  for (const Option& option : verb.options) bind_option(app, option, complete);
  if (verb.rest != nullptr) app.fallthrough(false)->prefix_command();
  for (const Verb& each : verb.verbs) bind(*app.add_subcommand(each.name, each.help), each, complete);
  if (complete && !verb.run) app.require_subcommand(1);
}

/// Names a verb that does not exist, which the parser would only call unexpected or missing.
void check_verb(const Verb& program, int argc, char** argv) {
  const Verb* at = &program;
  for (int i = 1; i < argc && argv[i][0] != '-' && !at->verbs.empty(); ++i) {
    const Verb* found = nullptr;
    std::vector<std::string> known;
    for (const Verb& verb : at->verbs) {
      known.push_back(verb.name);
      if (verb.name == argv[i]) found = &verb;
    }
    const std::string path = at == &program ? "" : at->name + " ";
    const auto renamed = at->renamed.find(argv[i]);
    if (renamed != at->renamed.end())
      throw common::ConfigError(path + argv[i] + " is now " + path + renamed->second);
    if (found == nullptr && at->run) return;  // a file that it takes
    if (found == nullptr)
      throw common::ConfigError("unknown verb " + path + argv[i] + "; " +
                                common::spelling_hint(argv[i], known, "verbs", path));
    at = found;
  }
}

/// All that is given may end in a JSON file, which holds nothing else.
void check_utf8(int argc, char** argv) {
  for (int i = 1; i < argc; ++i)
    if (!common::is_utf8(argv[i]))
      throw common::ConfigError("argument " + std::to_string(i) + " (" + common::shown(argv[i]) +
                                ") is no UTF-8: rename the file, or set the terminal to UTF-8");
}

Parsed chosen(const CLI::App& app, const Verb& program) {
  Parsed parsed{&program};
  const CLI::App* at = &app;
  while (!at->get_subcommands().empty()) {
    at = at->get_subcommands().front();
    parsed.path += (parsed.path.empty() ? "" : " ") + at->get_name();
    for (const Verb& verb : parsed.verb->verbs)
      if (verb.name == at->get_name()) parsed.verb = &verb;
    if (parsed.verb->rest != nullptr) *parsed.verb->rest = at->remaining();
  }
  for (const CLI::Option* option : at->get_options())
    if (!option->results().empty())
      parsed.given["--" + option->get_single_name()] = option->results().front();
  return parsed;
}

}  // namespace

Parsed parse(Verb& program, int argc, char** argv) {
  check_utf8(argc, argv);
  check_verb(program, argc, argv);
  CLI::App app(program.help);
  app.fallthrough();  // the program's own flag may stand behind the verb
  bind(app, program, true);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0) throw common::ConfigError(std::string(error.what()) + " (see --help)");
    return {nullptr, app.exit(error)};
  }
  return chosen(app, program);
}

void parse_only(Verb& program, const std::vector<std::string>& words, const std::string& what) {
  CLI::App app;
  app.fallthrough();
  bind(app, program, false);
  try {
    app.parse(std::vector<std::string>(words.rbegin(), words.rend()));  // it takes them from the back
  } catch (const CLI::ParseError& error) {
    throw common::ConfigError(what + error.what());
  }
}

}  // namespace lodestone::apps
