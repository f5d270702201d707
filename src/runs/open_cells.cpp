#include "lodestone/runs/open_cells.h"

#include <fnmatch.h>

#include <algorithm>
#include <set>
#include <unordered_map>
#include <unordered_set>

#include "lodestone/common/error.h"
#include "lodestone/runs/kept_results.h"

namespace lodestone::runs {
namespace {

/// The cells and all that they need, directly or not, as long as `needs_more` says so of one.
template <class NeedsMore>
std::vector<const Cell*> with_needs(const Plan& plan, const std::vector<const Cell*>& cells,
                                    const NeedsMore& needs_more) {
  std::unordered_map<std::string, const Cell*> by_id;
  for (const Cell& cell : plan.cells) by_id.emplace(cell.id, &cell);
  std::set<const Cell*> found(cells.begin(), cells.end());
  std::vector<const Cell*> open(cells.begin(), cells.end());
  while (!open.empty()) {
    const Cell* cell = open.back();
    open.pop_back();
    for (const std::string& id : cell->needs()) {
      const Cell* need = by_id.at(id);
      if (needs_more(*need) && found.insert(need).second) open.push_back(need);
    }
  }
  std::vector<const Cell*> in_order;
  for (const Cell& cell : plan.cells)
    if (found.count(&cell) > 0) in_order.push_back(&cell);
  return in_order;
}

bool finished(const Plan& plan, const PlanPlace& place, const Cell& cell) {
  const auto state = find_run(cell_folder(plan, place, cell.id));
  return state && state->finished;
}

}  // namespace

std::vector<const Cell*> cells_named(const Plan& plan, const std::string& name) {
  std::vector<const Cell*> found;
  for (const Cell& cell : plan.cells)
    if (cell.id == name || fnmatch(name.c_str(), cell.id.c_str(), 0) == 0) found.push_back(&cell);
  return found;
}

std::vector<const Cell*> wanted_cells(const Plan& plan, const std::string& only) {
  std::vector<const Cell*> all;
  for (const Cell& cell : plan.cells) all.push_back(&cell);
  if (only.empty()) return all;
  const std::vector<const Cell*> cells = cells_named(plan, only);
  if (cells.empty()) throw common::ConfigError("the plan has no cell \"" + only + "\"");
  return with_needs(plan, cells, [](const Cell&) { return true; });
}

std::vector<const Cell*> unfinished_cells(const Plan& plan, const PlanPlace& place,
                                          const std::vector<const Cell*>& cells) {
  const auto kept = place.results.empty() ? std::unordered_set<std::string>{}
                                          : KeptResults(place.results).finished(plan, place);
  std::vector<const Cell*> left;
  for (const Cell* cell : cells)
    if (kept.count(cell->id) == 0 && !finished(plan, place, *cell)) left.push_back(cell);
  return left;
}

std::vector<const Cell*> cells_to_run(const Plan& plan, const PlanPlace& place,
                                      const std::vector<const Cell*>& cells) {
  return with_needs(plan, unfinished_cells(plan, place, cells),
                    [&](const Cell& need) { return !finished(plan, place, need); });
}

}  // namespace lodestone::runs
