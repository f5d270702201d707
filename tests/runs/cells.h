#pragma once

#include <string>
#include <utility>
#include <vector>

#include "lodestone/common/files.h"
#include "lodestone/runs/open_cells.h"
#include "lodestone/runs/plan.h"

namespace lodestone::tests {

/// A cell of the verb collect.
inline runs::Cell cell(const std::string& id, std::vector<std::string> settings = {}) {
  runs::Cell made;
  made.id = id;
  made.verb = "collect";
  made.settings = std::move(settings);
  return made;
}

inline runs::Plan plan(std::vector<runs::Cell> cells) {
  runs::Plan made;
  made.cells = std::move(cells);
  return made;
}

/// A finished run with something that others need, and something that they do not.
inline void finish(const runs::Plan& made, const runs::PlanPlace& place, const std::string& id) {
  const std::string folder = runs::cell_folder(made, place, id);
  runs::RunFolder run({folder, made.find(id)->verb, common::Json::object()});
  run.begin();
  common::make_folders(folder + "/checkpoint");
  common::write_file_atomically(folder + "/checkpoint/weights", "of " + id);
  common::write_file_atomically(folder + "/log", "long");
  run.finish();
}

inline std::vector<std::string> ids(const std::vector<const runs::Cell*>& cells) {
  std::vector<std::string> out;
  for (const runs::Cell* cell : cells) out.push_back(cell->id);
  return out;
}

inline std::vector<std::string> to_run(const runs::Plan& made, const runs::PlanPlace& place) {
  return ids(runs::cells_to_run(made, place, runs::wanted_cells(made)));
}

using Ids = std::vector<std::string>;

}  // namespace lodestone::tests
