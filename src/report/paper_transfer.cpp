#include <initializer_list>
#include <map>

#include "lodestone/report/html.h"
#include "paper_page.h"
#include "trial_drawing.h"

namespace lodestone::report {
namespace {

constexpr double kDishRadius_mm = 42.5;
constexpr const char* kTransferNote =
    "Of a training seed, every row meets the same starts, targets, friction maps, temperatures and cameras, "
    "each trial on a rig of its own, and none of them was used for any choice. Trials start within 0.82 "
    "dish radii of the middle, and points lie within 0.7: the disc of targets that our TD3 trains on (the "
    "gradient on 0.85). Over the whole dish, starts lie within 0.96, wherever the needle fits, and points "
    "within 1, as the paper's TD3 trains; in the plain simulator it starts within 0.82. Rows of other "
    "numbers of seeds have other trials, too, and so have those over the whole dish: compare such rows by "
    "their differences from the bare pull, which are of the same trials. "
    "Bare: the controller alone. Identified: it is told how strongly the rig answers, which the pulses "
    "themselves say in our MBS. Decorated: stalled commands grow, pulls swing from side to side, no current "
    "within 1 mm of the target, and a path's target is fed 0.8 s ahead. Gradient and planner know where a "
    "path's target will be, bare, too; TD3 and pull chase it as it moves. Paper: its deviation from the "
    "targets, on its real rig; its Table II says mean errors, its section V-D calls the same figures RMS. "
    "Deviation, mean ± std with the 95 % interval of the mean: of points the "
    "distance at the end of a trial of 20 s, of the square the mean distance to the point that is fed at "
    "the time (they are fed one by one, at 2 mm/s; the paper does not say how fast, and what chases a "
    "faster one lies farther behind). Error, mean with its 95 % interval: of points the same, of the square "
    "the cross-track RMS; in time: the RMS distance to the point that is fed. From the bare pull: mean "
    "difference on the same trials with its interval, of the error and, of the square, of the deviation. "
    "Completion: share of the square's points that the "
    "needle came within 3 mm of, in order, within 3 s of their time. Success: within 3 mm; of the square a "
    "completion of 95 %, every corner within 3 mm, and a cross-track RMS within 3 mm. A trial that was "
    "stopped is scored with the needle where it lay. Intervals draw training seeds and, in them, trials "
    "anew; of one seed its trials alone, so that they say nothing of other seeds. Where seeds differ more "
    "than trials do, such an interval is hardly wider than the means of seeds lie apart: two have the mean "
    "of all between them half of the time, three three times of four, five fifteen of sixteen. Simulators "
    "and pull have the description's parameters: how a rig differs from it is hidden from everybody. "
    "Trained: by mean of the seeds that drove, and in how many seconds with nothing beside it (Table I); "
    "for the centre the gradient's policy is the one for points. What success a policy has in the simulator "
    "that it learned in stands in Table I: where that is low, what is missing here was not all lost on the "
    "way.";

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
      {"whole_dish", "bare, over the whole dish"},
      {"identified", "bare, identified"},
      {"decorated", "decorated"},
      {"identified_decorated", "decorated, identified"}};
  return kVariants;
}

std::string shown_variant(const std::string& key) {
  for (const auto& [variant, name] : variants())
    if (key == variant) return name;
  return key;
}

/// Of points the same as the error.
std::string deviation_text(const runs::PooledErrors& e) {
  const std::string text = formatted("%.2f ± %.2f", e.target_deviation_mm.value_or(e.mean_error_mm),
                                     e.target_deviation_std_mm.value_or(e.std_error_mm));
  if (!e.target_deviation_interval_mm) return text;
  const auto [low, high] = *e.target_deviation_interval_mm;
  return text + formatted(" (%.2f to %.2f)", low, high);
}

std::string seconds_text(const PaperPage& page, const Row& row, const std::string& task,
                         const runs::PooledTraining& training) {
  const auto* paces = find(page.result.paces, row.key);
  if (paces == nullptr) return "–";
  const runs::TrainingPace* pace = find(*paces, task == "centre" ? "centre" : "target");
  if (pace == nullptr) pace = find(*paces, "target");
  return pace != nullptr ? grouped(pace->seconds_to(training.env_steps)) : "–";
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
                                    training ? seconds_text(page, row, task, *training) : "–"};
  if (task == "square")
    cells.insert(cells.begin() + 6, {with_interval("%+.2f", f.target_deviation_from_reference_mm,
                                                   f.target_deviation_from_reference_interval_mm),
                                     with_interval("%.2f", f.time_rms_error_mm, f.time_rms_interval_mm),
                                     percent_text(f.completion, f.completion_interval),
                                     percent_text(f.corners_reached, f.corners_interval)});
  return cells;
}

std::string signed_mean(const runs::PooledMean& difference, const char* format, double scale = 1.0) {
  return formatted(format, scale * difference.mean, scale * difference.interval[0],
                   scale * difference.interval[1]);
}

/// Who is closer, as far as that is told apart.
std::string closer(const runs::PooledMean& difference) {
  if (difference.interval[1] < 0.0) return "learned";
  return difference.interval[0] > 0.0 ? "plain" : "not told apart";
}

/// What "closer" rests on.
std::string compared_note(const PaperPage& page) {
  std::size_t few = 0;
  for (const auto& [row, its_variants] : page.result.learned_minus_plain)
    for (const auto& [variant, tasks] : its_variants)
      for (const auto& [task, paired] : tasks) few += paired.n_seeds < kEnoughSeeds ? 1 : 0;
  if (few == 0) return "";
  return " Closer, in the last table, is where the interval leaves no doubt; " + std::to_string(few) +
         " of its rows have fewer than " + std::to_string(kEnoughSeeds) +
         " training seeds, and say so of these alone.";
}

PaperTable learned_minus_plain(const PaperPage& page) {
  constexpr const char* kMillimetres = "%+.2f (%+.2f to %+.2f)";
  PaperTable table{{"controller", "around it", "task", "error (mm)", "closer", "deviation (mm)", "closer",
                    "success (points of a hundred)", "trials", "seeds"}};
  table.text_columns = 3;
  struct Pair {
    const char *key, *plain, *name;
  };
  for (const auto& [key, plain, name] : std::initializer_list<Pair>{
           {"paper", "paper_simulator", "TD3 as the paper's"}, {"best", "simulator", "our TD3"}}) {
    const auto* its_variants = find(page.result.learned_minus_plain, key);
    if (its_variants == nullptr) continue;
    for (const auto& [variant, tasks] : *its_variants)
      for (const auto& [task, paired] : tasks) {
        for (const char* row : {key, plain}) table.add_commits(page.errors(row, variant, task)->origin);
        const runs::PooledMean deviation = paired.target_deviation_mm.value_or(paired.error_mm);
        table.cells.push_back({name, shown_variant(variant), task, signed_mean(paired.error_mm, kMillimetres),
                               closer(paired.error_mm), signed_mean(deviation, kMillimetres),
                               closer(deviation),
                               signed_mean(paired.success_rate, "%+.0f (%+.0f to %+.0f)", 100.0),
                               std::to_string(paired.n_trials), std::to_string(paired.n_seeds)});
      }
  }
  return table;
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
                      "success", "stopped", "trials", "seeds", "trained for (steps)", "in (s), alone"}};
    if (path)
      table.headers.insert(table.headers.begin() + 6,
                           {"deviation, from the bare pull's", "in time", "completion", "corners"});
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
  PaperTable compared = learned_minus_plain(page);
  if (!compared.cells.empty())
    tables.emplace_back("Table II: trained in a learned simulator minus in the plain one, on the same trials",
                        std::move(compared));
  page.add_part("transfer", "Table II and Fig. 6, transfer to unseen rigs by camera",
                std::string(kTransferNote) + compared_note(page), tables,
                figure("<div class=\"panels\">" + drawings + "</div>",
                       "<b>Fig. 6.</b> True trajectories of one training seed on unseen rigs."));
}

}  // namespace lodestone::report
