#include <algorithm>
#include <cstdio>
#include <memory>

#include "verb.h"

namespace lodestone::apps {
namespace {

void print_rows(const std::vector<common::ConfigRow>& rows) {
  const auto width = [&rows](const char* title, auto member) {
    std::size_t widest = std::string(title).size();
    for (const common::ConfigRow& row : rows) widest = std::max(widest, (row.*member).size());
    return static_cast<int>(widest);
  };
  const int key = width("key", &common::ConfigRow::key);
  const int value = width("default", &common::ConfigRow::value);
  const int unit = width("unit", &common::ConfigRow::unit);
  const int bounds = width("bounds", &common::ConfigRow::bounds);
  const auto line = [&](const char* a, const char* b, const char* c, const char* d, const char* e) {
    std::printf("%-*s  %-*s  %-*s  %-*s  %s\n", key, a, value, b, unit, c, bounds, d, e);
  };
  line("key", "default", "unit", "bounds", "meaning");
  for (const common::ConfigRow& row : rows)
    line(row.key.c_str(), row.value.c_str(), row.unit.c_str(), row.bounds.c_str(), row.meaning.c_str());
}

}  // namespace

void add_config(CLI::App& program, ConfigCatalogue& catalogue) {
  CLI::App* verb = program.add_subcommand("config", "show every configuration key of a verb");
  auto name = std::make_shared<std::string>();
  verb->add_option("--print", *name, "the verb whose keys, defaults, units and meanings to print")
      ->type_name("VERB")
      ->required();
  verb->callback([name, &catalogue] {
    const auto found = catalogue.find(*name);
    if (found == catalogue.end()) {
      std::string known;
      for (const auto& entry : catalogue) known += (known.empty() ? "" : ", ") + entry.first;
      throw common::ConfigError("config --print " + *name + ": verbs with a configuration are " + known);
    }
    print_rows(found->second());
  });
}

}  // namespace lodestone::apps
