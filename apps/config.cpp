#include <algorithm>
#include <cstdio>

#include "verb.h"

namespace lodestone::apps {
namespace {

void print_rows(const std::vector<common::ConfigRow>& rows) {
  const auto width = [&rows](const char* title, auto text) {
    std::size_t widest = std::string(title).size();
    for (const common::ConfigRow& row : rows) widest = std::max(widest, text(row).size());
    return static_cast<int>(widest);
  };
  const int key = width("key", [](const auto& row) { return row.key; });
  const int value = width("value", [](const auto& row) { return row.value.dump(); });
  const int unit = width("unit", [](const auto& row) { return row.unit; });
  const int bounds = width("bounds", [](const auto& row) { return row.bounds; });
  const int source = width("default", [](const auto& row) { return row.source; });
  const auto line = [&](const char* a, const char* b, const char* c, const char* d, const char* e,
                        const char* f) {
    std::printf("%-*s  %-*s  %-*s  %-*s  %-*s  %s\n", key, a, value, b, source, c, unit, d, bounds, e, f);
  };
  line("key", "value", "from", "unit", "bounds", "meaning");
  for (const common::ConfigRow& row : rows)
    line(row.key.c_str(), row.value.dump().c_str(), row.source.empty() ? "default" : row.source.c_str(),
         row.unit.c_str(), row.bounds.c_str(), row.meaning.c_str());
}

/// Parses a verb's arguments as the verb would, without running it.
void parse_only(CLI::App& program, const std::vector<std::string>& words, std::size_t words_of_verb) {
  CLI::App* verb = &program;
  for (std::size_t i = 0; i < words_of_verb; ++i) {
    verb = verb->get_subcommand(words[i]);
    verb->callback([] {});
    verb->require_subcommand(0);
    for (CLI::Option* option : verb->get_options()) option->required(false);
  }
  program.parse(std::vector<std::string>(words.rbegin(), words.rend()));  // it takes them from the back
}

void print_config(const std::vector<std::string>& words) {
  CLI::App program;
  program.fallthrough();
  program.add_flag("--no-reexec");  // the program's own, which may stand behind the verb
  ConfigCatalogue catalogue;
  add_verbs(program, catalogue);
  // The verb may be of two words.
  std::size_t used = std::min<std::size_t>(2, words.size());
  std::string name;
  for (; used > 0; --used) {
    name = words[0] + (used > 1 ? " " + words[1] : "");
    if (catalogue.count(name) != 0) break;
  }
  if (used == 0) {
    std::string known;
    for (const auto& entry : catalogue) known += (known.empty() ? "" : ", ") + entry.first;
    throw common::ConfigError("config --print " + (words.empty() ? "" : words[0]) +
                              ": verbs with a configuration are " + known);
  }
  try {
    parse_only(program, words, used);
  } catch (const CLI::ParseError& error) {
    throw common::ConfigError("config --print " + name + ": " + error.what());
  }
  print_rows(catalogue.at(name)());
}

}  // namespace

void add_config(CLI::App& program, ConfigCatalogue&) {
  CLI::App* verb = program.add_subcommand(
      "config",
      "show every configuration key of a verb: its value, where that comes from, its bounds and meaning");
  verb->add_flag("--print", "followed by the verb and the arguments that it would be given");
  verb->fallthrough(false);
  verb->prefix_command();
  verb->callback([verb] { print_config(verb->remaining()); });
}

}  // namespace lodestone::apps
