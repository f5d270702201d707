#include <cstdio>
#include <memory>

#include "lodestone/common/error.h"
#include "lodestone/experiments/integrity.h"
#include "verbs.h"

namespace lodestone::apps {
namespace {

void check(const std::string& path) {
  std::size_t damaged = 0;
  const auto items = experiments::check_integrity(path);
  for (const experiments::CheckedItem& item : items) {
    if (item.problem.empty()) {
      std::printf("whole    %s: %s\n", item.path.c_str(), item.what.c_str());
    } else {
      std::printf("DAMAGED  %s\n", item.problem.c_str());
      ++damaged;
    }
  }
  if (damaged > 0)
    throw common::DataError("check: " + std::to_string(damaged) + " of " + std::to_string(items.size()) +
                            " things in " + path + " are damaged; each line above says what to do");
}

}  // namespace

void add_check(Verb& program) {
  Verb& verb = program.add_verb(
      "check", "read a recording, a checkpoint or a folder of runs, and say what is damaged");
  const auto path = std::make_shared<std::string>();
  verb.add_option("path", path.get(), "a file, or a folder, of which everything below is read")
      .named("FILE|DIR")
      .required();
  verb.run = [path] { check(*path); };
}

}  // namespace lodestone::apps
