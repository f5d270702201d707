#include <map>

#include "lodestone/report/html.h"
#include "paper_page.h"
#include "trial_drawing.h"

namespace lodestone::report {
namespace {

constexpr double kDishRadius_mm = 42.5;
constexpr const char* kTransferNote =
    "Of a training seed, every row meets the same starts, targets, friction maps, temperatures and "
    "cameras, each trial on a rig of its own, and none of them was used for any choice; rows of other "
    "numbers of seeds have other trials, too: compare such rows by their differences from the bare pull, "
    "which are of the same trials. Bare: the controller alone. Identified: it is told how strongly the "
    "rig answers, which the pulses themselves say in our MBS. Decorated: stalled commands grow, pulls "
    "swing from side to side, no current within 1 mm of the target. Paper: its deviation from the "
    "targets, on its real rig. Deviation, mean ± std: of points the distance at the end of a trial of 20 "
    "s, of the square the mean distance to the point that is fed at the time (they are fed one by one). "
    "Error, mean with its 95 % interval: of points the same, of the square the cross-track RMS; in time: "
    "the RMS distance to the point that is fed. From the bare pull: mean difference on the same trials "
    "with its interval. Completion: share of the square's points that the needle came within 3 mm of, in "
    "order, within 3 s of their time. Success: within 3 mm; of the square a completion of 95 %, every "
    "corner within 3 mm, and a cross-track RMS within 3 mm. A trial that was stopped is scored with the "
    "needle where it lay. Intervals draw training seeds and, in them, trials anew; of one seed its "
    "trials alone, so that they say nothing of other seeds. Where seeds differ more than trials do, such "
    "an interval is hardly wider than the means of seeds lie apart: two have the mean of all between "
    "them half of the time, three three times of four, five fifteen of sixteen. Simulators and pull have "
    "the description's parameters: how a rig differs from it is hidden from everybody. Trained: the "
    "seeds that drove; seconds are of those that had one thread, beside whatever else the machine did "
    "(Table I says of which processor), and a dash stands where none had.";

/// A row of table II: what drives, and what the paper measured with it.
struct Row {
  const char* key;
  const char* name;
  std::map<std::string, const char*> published;
};

const std::vector<Row>& rows() {
  static const std::vector<Row> kRows = {
      {"paper_simulator", "TD3 as the paper's, in the plain simulator", {{"centre", "31 ± 29"}}},
      {"paper",
       "TD3 as the paper's, in an MBS as the paper's",
       {{"centre", "6.3 ± 2.1"}, {"point", "5.3 ± 0.8"}, {"square", "7.4 ± 0.7"}}},
      {"simulator", "our TD3, in the plain simulator", {}},
      {"randomised", "our TD3, in the randomised simulator", {}},
      {"best", "our TD3, in our MBS", {}},
      {"any_rig", "policy down our MBS' gradient", {}},
      {"planner", "planner in our MBS", {}},
      {"baseline", "proportional pull", {}},
      {"offline", "our TD3, on recorded steps alone", {}}};
  return kRows;
}

const std::vector<std::pair<const char*, const char*>>& variants() {
  static const std::vector<std::pair<const char*, const char*>> kVariants = {
      {"bare", "bare"},
      {"identified", "bare, identified"},
      {"decorated", "decorated"},
      {"identified_decorated", "decorated, identified"}};
  return kVariants;
}

/// Of points the same as the error.
std::string deviation_text(const runs::PooledErrors& e) {
  return formatted("%.2f ± %.2f", e.target_deviation_mm.value_or(e.mean_error_mm),
                   e.target_deviation_std_mm.value_or(e.std_error_mm));
}

/// Says of how many seeds where those are not all.
std::string seconds_text(const runs::PooledTraining& training) {
  if (!training.train_seconds) return "–";
  const bool all = training.n_timed == training.origin.n_seeds;
  return grouped(*training.train_seconds) +
         (all ? ""
              : " (" + std::to_string(training.n_timed) + (training.n_timed == 1 ? " seed)" : " seeds)"));
}

std::vector<std::string> cells_of(const PaperPage& page, const Row& row, const std::string& variant,
                                  const std::string& variant_name, const std::string& task,
                                  const runs::PooledErrors& f, const SeedRecords& driven) {
  const auto published = row.published.find(task);
  const bool as_published = published != row.published.end() && variant == "bare";
  const auto training = page.training_of(row.key, task, driven);
  std::vector<std::string> cells = {row.name,
                                    variant_name,
                                    as_published ? published->second : "–",
                                    deviation_text(f),
                                    error_text(f),
                                    from_reference_text(f),
                                    success_text(f),
                                    std::to_string(f.n_stopped),
                                    std::to_string(f.n_trials),
                                    seeds_text(f.origin),
                                    training ? grouped(training->env_steps) : "–",
                                    training ? seconds_text(*training) : "–"};
  if (task == "square")
    cells.insert(cells.begin() + 6,
                 {or_dash("%.2f", f.time_rms_error_mm), or_dash("%.0f %%", f.completion, 100.0),
                  or_dash("%.0f %%", f.corners_reached, 100.0)});
  return cells;
}

/// The trials of the first seed that are kept for drawing; empty where there are none.
std::string drawing(PaperPage& page, const SeedRecords& seeds, const Row& row, const std::string& variant,
                    const std::string& variant_name, const std::string& task) {
  for (const auto& [seed, record] : seeds.found) {
    const auto& drawn = record->trials->drawn;
    if (drawn.empty()) continue;
    const std::vector<Trial> trials = read_trials(drawn);
    std::string svg = draw_trials(select(trials, task, record->trials->controller), kDishRadius_mm,
                                  "Trajectories: " + task + ", " + row.name + ", " + variant_name);
    page.drawings.emplace_back(std::string(row.key) + "_" + variant + "_" + task, svg);
    return "<div class=\"panel\">" + svg + "<b>" + escape(task) + "</b><br>" + escape(row.name) + ", " +
           escape(variant_name) + "</div>";
  }
  return "";
}

}  // namespace

void add_transfer(PaperPage& page) {
  std::string drawings;
  std::vector<std::pair<std::string, PaperTable>> tables;
  for (const char* task : {"centre", "point", "square"}) {
    const bool path = std::string(task) == "square";
    PaperTable table{{"controller", "around it", "paper", "deviation", "error", "from the bare pull",
                      "success", "stopped", "trials", "seeds", "trained for (steps)", "in (s)"}};
    if (path) table.headers.insert(table.headers.begin() + 6, {"in time", "completion", "corners"});
    for (const Row& row : rows()) {
      for (const auto& [variant, variant_name] : variants()) {
        const std::string prefix = std::string("transfer/") + row.key + "/" + variant + "/" + task;
        if (!page.planned(prefix)) continue;
        const runs::PooledErrors* f = page.errors(row.key, variant, task);
        if (f == nullptr) {
          table.add_missing({row.name, variant_name});
          continue;
        }
        const SeedRecords& driven = *page.by_id.at(prefix);
        table.cells.push_back(cells_of(page, row, variant, variant_name, task, *f, driven));
        table.add_commits(f->origin);
        if (const auto training = page.training_of(row.key, task, driven))
          table.add_commits(training->origin);
        drawings += drawing(page, driven, row, variant, variant_name, task);
      }
    }
    if (!table.cells.empty())
      tables.emplace_back(std::string("Table II: ") + task + ", in mm", std::move(table));
  }
  if (tables.empty()) return;
  page.add_part("transfer", "Table II and Fig. 6, transfer to unseen rigs by camera", kTransferNote, tables,
                figure("<div class=\"panels\">" + drawings + "</div>",
                       "<b>Fig. 6.</b> True trajectories of one training seed on unseen rigs."));
}

}  // namespace lodestone::report
