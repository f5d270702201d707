#include <algorithm>
#include <cstdio>
#include <memory>

#include "lodestone/common/error.h"
#include "parser.h"
#include "verbs.h"

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

}  // namespace

std::vector<common::ConfigRow> configuration_rows(const std::vector<std::string>& words,
                                                  const std::string& what) {
  Verb program{"lodestone", ""};
  add_verbs(program);
  bool ignored = false;
  program.add_option("--no-reexec", &ignored, "");  // the program's own, which may stand behind the verb
  const Verb* verb = &program;
  std::string path;
  for (const std::string& word : words) {
    const auto found = std::find_if(verb->verbs.begin(), verb->verbs.end(),
                                    [&word](const Verb& each) { return each.name == word; });
    if (found == verb->verbs.end()) break;
    verb = &*found;
    path += (path.empty() ? "" : " ") + word;
  }
  if (!verb->configuration) {
    std::string known;
    for (const std::string& each : configured_verbs(program)) known += (known.empty() ? "" : ", ") + each;
    throw common::ConfigError(what + (words.empty() ? "" : words[0]) + ": verbs with a configuration are " +
                              known);
  }
  parse_only(program, words, what + path + ": ");
  try {
    return verb->configuration();
  } catch (const common::ConfigError& error) {
    throw common::ConfigError(what + path + ": " + error.what());
  }
}

void add_config(Verb& program) {
  Verb& verb = program.add_verb(
      "config",
      "show every configuration key of a verb: its value, where that comes from, its bounds and meaning");
  struct Words {
    std::vector<std::string> rest;
    bool print = false;  // there is nothing else that it could do
  };
  const auto words = std::make_shared<Words>();
  verb.add_option("--print", &words->print, "followed by the verb and the arguments that it would be given");
  verb.rest = &words->rest;
  verb.run = [words] { print_rows(configuration_rows(words->rest, "config --print ")); };
}

}  // namespace lodestone::apps
