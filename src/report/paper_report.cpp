#include "lodestone/report/paper_report.h"

#include <algorithm>

#include "lodestone/common/artefact.h"
#include "lodestone/common/files.h"
#include "lodestone/report/html.h"
#include "paper_page.h"
#include "trial_drawing.h"

namespace lodestone::report {
namespace {

/// Rows whose seeds were run with presets that differ: the one that is now, and one before it.
std::string of_two_presets(const PaperPage& page) {
  std::vector<std::string> rows;
  for (const auto& [prefix, seeds] : page.groups)
    if (std::any_of(seeds.found.begin(), seeds.found.end(), [&seeds = seeds](const auto& found) {
          return found.second->preset != seeds.found.front().second->preset;
        }))
      rows.push_back(prefix);
  return rows.empty() ? "" : " Seeds of these rows were run with presets that differ: " + joined(rows) + ".";
}

void add_summary(PaperPage& page) {
  std::string text =
      (page.result.scale == "full"
           ? ""
           : "Scale " + page.result.scale +
                 ", smaller than the paper's: for the paper's own sizes see the full one. ") +
      std::to_string(page.result.n_cells) + " of " + std::to_string(page.result.n_cells_planned) +
      " cells are finished (" + formatted("%.1f", page.result.cell_hours) + " hours, one after another), " +
      (page.result.dates.empty() ? ""
                                 : page.result.dates.front() + " to " + page.result.dates.back() + ", ") +
      "commits " + joined(page.result.commits) + ", on " + joined(page.result.machines) + "." +
      of_two_presets(page);
  page.markdown += text + "\n\n";
  page.html.add_section("what", "What this is", "<p>" + escape(text) + "</p>");
}

void add_origins(PaperPage& page) {
  std::vector<std::vector<std::string>> cells;
  for (const runs::Cell& cell : page.kept.plan.cells) {
    const auto found = page.kept.records.find(cell.id);
    if (found == page.kept.records.end()) {
      cells.push_back({escape(cell.id), kMissing, "", "", "", "", ""});
      continue;
    }
    const runs::CellRecord& record = found->second;
    cells.push_back({escape(cell.id), escape(cell.config.empty() ? "–" : cell.config),
                     std::to_string(record.seed), escape(joined(record.manifest_texts("git_commit"))),
                     escape(joined(record.manifest_texts("processor"))), std::to_string(record.threads()),
                     formatted("%.0f", record.seconds)});
  }
  page.html.add_section(
      "cells", "Where each cell comes from",
      "<details><summary>" + std::to_string(cells.size()) + " cells</summary>" +
          table({"cell", "preset", "seed", "commit", "processor", "threads", "time (s)"}, cells, 5) +
          "</details>");
}

}  // namespace

std::string write_paper_report(const runs::KeptPlan& kept, const runs::KeptPlan& paces,
                               const std::string& folder) {
  PaperPage page(kept, paces);
  add_summary(page);
  add_transfer(page);
  add_training(page);
  add_dynamics(page);
  add_zones(page);
  add_mixes(page);
  add_open_choices(page);
  add_ablations(page);
  add_origins(page);
  common::make_folders(folder);
  common::write_artefact(folder + "/" + runs::PaperResult::kFile, page.result);
  for (const auto& [name, drawing] : page.drawings) write_svg(folder + "/images/" + name + ".svg", drawing);
  common::write_file_atomically(folder + "/table.md", page.markdown);
  common::write_file_atomically(folder + "/report.html", page.html.render());
  return page.markdown;
}

}  // namespace lodestone::report
