#include <algorithm>
#include <cstdio>
#include <memory>

#include "lodestone/common/shown.h"
#include "lodestone/runs/plan.h"
#include "verbs.h"

namespace lodestone::apps {
namespace {

void print_run(const runs::StatusRow& row, int width) {
  if (!row.state) {
    const std::string waits =
        "waiting" + (row.waits_for.empty() ? "" : "   for " + common::escaped(row.waits_for));
    const std::string how = row.failure.empty() ? waits : "failed    " + common::escaped(row.failure);
    std::printf("%-*s  %s\n", width, row.name.c_str(), how.c_str());
    return;
  }
  const runs::RunState& state = *row.state;
  std::string far;
  if (state.total > 0)
    far = std::to_string(
              static_cast<int>(100.0 * static_cast<double>(state.done) / static_cast<double>(state.total))) +
          " %  " + std::to_string(state.done) + " of " + std::to_string(state.total) + " " +
          common::escaped(state.unit);
  const std::string said = row.failure.empty() ? "" : "  " + common::escaped(row.failure);
  std::printf("%-*s  %-8s  %-15s  %s%s%s  %s%s\n", width, row.name.c_str(),
              state.finished ? "finished"
              : row.running  ? "running"
                             : "stopped",
              common::escaped(state.verb).c_str(), far.c_str(), state.note.empty() ? "" : "  ",
              common::escaped(state.note).c_str(), common::escaped(state.updated_utc).c_str(), said.c_str());
}

void status(const std::string& folder) {
  const std::vector<runs::StatusRow> rows = runs::status_of(folder);
  std::size_t width = 0;
  std::size_t finished = 0;
  for (const runs::StatusRow& row : rows) {
    width = std::max(width, row.name.size());
    if (row.state && row.state->finished) ++finished;
  }
  for (const runs::StatusRow& row : rows) print_run(row, static_cast<int>(width));
  if (rows.size() > 1) std::printf("%zu of %zu runs are finished\n", finished, rows.size());
}

}  // namespace

void add_status(Verb& program) {
  Verb& verb = program.add_verb("status", "how far a run is, a plan, or all runs below a folder");
  const auto folder = std::make_shared<std::string>();
  verb.add_option("folder", folder.get(), "the --out of a run or plan, or a folder of them")
      .named("DIR")
      .required();
  verb.run = [folder] { status(*folder); };
}

}  // namespace lodestone::apps
