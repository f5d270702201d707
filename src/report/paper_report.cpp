#include "lodestone/report/paper_report.h"

#include <cstdio>
#include <map>
#include <optional>
#include <vector>

#include "lodestone/common/artefact.h"
#include "lodestone/common/files.h"
#include "lodestone/common/statistics.h"
#include "lodestone/report/charts.h"
#include "lodestone/report/dish_svg.h"
#include "lodestone/report/html.h"
#include "lodestone/report/html_page.h"
#include "lodestone/report/paper_figures.h"
#include "trial_drawing.h"

namespace lodestone::report {
namespace {

constexpr double kDishRadius_mm = 42.5;
constexpr const char* kMissing = "not run yet";
constexpr std::int64_t kEnoughTrials = 200;  // for a sentence about an ablation,
constexpr std::int64_t kEnoughSeeds = 5;     // over so many training seeds

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

std::string text_of(const char* format, double a, double b = 0.0, double c = 0.0) {
  char buffer[128];
  std::snprintf(buffer, sizeof buffer, format, a, b, c);
  return buffer;
}

std::string or_dash(const char* format, const std::optional<double>& value, double scale = 1.0) {
  return value ? text_of(format, scale * *value) : "–";
}

std::string error_text(const runs::PooledErrors& e) {
  return text_of("%.2f (%.2f to %.2f)", e.mean_error_mm, e.mean_interval_mm[0], e.mean_interval_mm[1]);
}

std::string success_text(const runs::PooledErrors& e) {
  return text_of("%.0f %% (%.0f to %.0f)", 100.0 * e.success_rate, 100.0 * e.success_interval[0],
                 100.0 * e.success_interval[1]);
}

/// Of points the same as the error.
std::string deviation_text(const runs::PooledErrors& e) {
  return text_of("%.2f ± %.2f", e.target_deviation_mm.value_or(e.mean_error_mm),
                 e.target_deviation_std_mm.value_or(e.std_error_mm));
}

std::string from_baseline_text(const runs::PooledErrors& e) {
  if (!e.from_baseline_mm || !e.from_baseline_interval_mm) return "–";
  return text_of("%+.2f (%+.2f to %+.2f)", *e.from_baseline_mm, (*e.from_baseline_interval_mm)[0],
                 (*e.from_baseline_interval_mm)[1]);
}

std::string seeds_text(const runs::CellOrigin& origin) {
  return std::to_string(origin.n_seeds) + " of " + std::to_string(origin.n_seeds_planned);
}

std::string joined(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : ", ") + part;
  return text;
}

/// A table as HTML and Markdown at once.
struct Table {
  std::vector<std::string> headers;
  std::vector<std::vector<std::string>> cells = {};
  int text_columns = 2;

  /// A row whose figures are not there.
  void add_missing(std::vector<std::string> named) {
    named.emplace_back(kMissing);
    named.resize(headers.size());
    cells.push_back(std::move(named));
  }
  std::string html() const {
    std::vector<std::vector<std::string>> escaped = cells;
    for (auto& row : escaped)
      for (std::size_t i = 0; i < row.size(); ++i) {
        row[i] = escape(row[i]);
        if (static_cast<int>(i) < text_columns) row[i] = "<span class=\"whole\">" + row[i] + "</span>";
      }
    return table(headers, escaped, text_columns);
  }
  std::string markdown() const {
    const auto line = [](const std::vector<std::string>& row) {
      std::string out = "|";
      for (const std::string& cell : row) out += " " + cell + " |";
      return out + "\n";
    };
    std::string out = line(headers) + "|";
    for (std::size_t i = 0; i < headers.size(); ++i) out += " --- |";
    out += "\n";
    for (const auto& row : cells) out += line(row);
    return out;
  }
};

template <class Map>
const typename Map::mapped_type* find(const Map& map, const std::string& key) {
  const auto found = map.find(key);
  return found == map.end() ? nullptr : &found->second;
}

/// Everything the page says, part by part.
class PaperReport {
 public:
  PaperReport(const runs::KeptPlan& kept, std::string folder)
      : kept_(kept),
        groups_(by_prefix(kept)),
        result_(paper_figures(kept)),
        folder_(std::move(folder)),
        page_("The paper's experiments, on the virtual rig",
              "Section V beside ours: every figure of ours is measured against the true pose on virtual rigs "
              "that no "
              "training saw; the paper's are from its real rig") {
    for (const auto& [prefix, seeds] : groups_) by_id_[prefix] = &seeds;
  }

  void summary() {
    std::string text =
        (result_.scale == "full"
             ? ""
             : "Scale " + result_.scale +
                   ", smaller than the paper's: for the paper's own sizes see the full one. ") +
        std::to_string(result_.n_cells) + " of " + std::to_string(result_.n_cells_planned) +
        " cells are finished (" + text_of("%.1f", result_.cell_hours) + " hours, one after another), " +
        (result_.dates.empty() ? "" : result_.dates.front() + " to " + result_.dates.back() + ", ") +
        "commits " + joined(result_.commits) + ", on " + joined(result_.machines) + ".";
    markdown_ += text + "\n\n";
    page_.add_section("what", "What this is", "<p>" + escape(text) + "</p>");
  }

  void transfer() {
    std::string html, drawings;
    for (const char* task : {"centre", "point", "square"}) {
      const bool path = std::string(task) == "square";
      Table table{{"controller", "around it", "paper", "deviation", "error", "from the bare pull", "success",
                   "stopped", "trials", "seeds", "trained for", "in (s)"}};
      if (path) table.headers.insert(table.headers.begin() + 6, {"in time", "completion", "corners"});
      for (const Row& row : rows()) {
        for (const auto& [variant, variant_name] : variants()) {
          const std::string prefix = std::string("transfer/") + row.key + "/" + variant + "/" + task;
          if (by_id_.count(prefix) == 0) continue;
          const runs::PooledErrors* f = errors(row.key, variant, task);
          if (f == nullptr) {
            table.add_missing({row.name, variant_name});
            continue;
          }
          const auto published = row.published.find(task);
          const bool as_published = published != row.published.end() && std::string(variant) == "bare";
          const runs::PooledTraining* training = training_of(row.key, task);
          std::vector<std::string> cells = {row.name,
                                            variant_name,
                                            as_published ? published->second : "–",
                                            deviation_text(*f),
                                            error_text(*f),
                                            from_baseline_text(*f),
                                            success_text(*f),
                                            std::to_string(f->n_stopped),
                                            std::to_string(f->n_trials),
                                            seeds_text(f->origin),
                                            training ? grouped(training->env_steps) : "–",
                                            training ? grouped(training->train_seconds) : "–"};
          if (path)
            cells.insert(cells.begin() + 6,
                         {or_dash("%.2f", f->time_rms_error_mm), or_dash("%.0f %%", f->completion, 100.0),
                          or_dash("%.0f %%", f->corners_reached, 100.0)});
          table.cells.push_back(std::move(cells));
          drawings += drawing(*by_id_[prefix], row, variant, variant_name, task);
        }
      }
      if (table.cells.empty()) continue;
      const std::string title = std::string(task) + ", in mm";
      markdown_ += "Table II, transfer to unseen rigs by camera: " + title + "\n\n" + table.markdown() + "\n";
      html += "<h3>" + title + "</h3>" + table.html();
    }
    if (html.empty()) return;
    page_.add_section("transfer", "Table II and Fig. 6: transfer",
                      "<p>Every row meets the same starts, targets, friction maps, temperatures and cameras, "
                      "each trial on a rig of its own, and none of "
                      "them was used for any choice. Bare: the controller alone. Identified: it is told how "
                      "strongly the rig answers, which the pulses "
                      "themselves say in our MBS. Decorated: stalled commands grow, pulls swing from side to "
                      "side, no current within 1 mm of the target. "
                      "Paper: its deviation from the targets, on its real rig. Deviation, mean ± std: of "
                      "points the distance at the end of a trial of 20 s, "
                      "of the square the mean distance to the point that is fed at the time (they are fed "
                      "one by one). Error, mean with its 95 % interval: of "
                      "points the same, of the square the cross-track RMS; in time: the RMS distance to the "
                      "point that is fed. From the bare pull: mean "
                      "difference on the same trials with its interval. Completion: share of the square's "
                      "points that the needle came within 3 mm of, in "
                      "order, within 3 s of their time. Success: within 3 mm; of the square a completion of "
                      "95 %, every corner within 3 mm, and a cross-track "
                      "RMS within 3 mm. A trial that was stopped is scored with the needle where it lay. "
                      "Intervals draw training seeds and rigs anew. "
                      "Simulators and pull have the description's parameters: how a rig differs from it is "
                      "hidden from everybody. Trained for so many "
                      "environment steps, on one thread.</p>" +
                          html +
                          figure("<div class=\"panels\">" + drawings + "</div>",
                                 "<b>Fig. 6.</b> True trajectories of one training seed on unseen rigs."));
  }

  void training() {
    struct Trained {
      const char *row, *task, *name, *published;
    };
    Table table{{"policy", "paper: time to maximum", "steps", "time to maximum (s)", "of the processor (s)",
                 "whole training (s)", "of the processor (s)", "steps/s of the processor",
                 "success in its own simulator", "seeds that had converged"}};
    std::string charts;
    for (const Trained& t : std::initializer_list<Trained>{
             {"paper", "centre", "as the paper's, MBS, centre", "1.5 h"},
             {"paper", "target", "as the paper's, MBS, random target", "3.5 h"},
             {"paper_simulator", "centre", "as the paper's, plain simulator, centre", "5.5 h"},
             {"paper_simulator", "target", "as the paper's, plain simulator, random target", "27 h"},
             {"best", "centre", "our TD3, MBS, centre", "–"},
             {"best", "target", "our TD3, MBS, random target", "–"},
             {"simulator", "centre", "our TD3, plain simulator, centre", "–"},
             {"simulator", "target", "our TD3, plain simulator, random target", "–"},
             {"randomised", "centre", "our TD3, randomised simulator, centre", "–"},
             {"randomised", "target", "our TD3, randomised simulator, random target", "–"},
             {"any_rig", "target", "down our MBS' gradient, random target", "–"}}) {
      const std::string prefix = std::string("policy/") + t.row + "/" + t.task;
      if (by_id_.count(prefix) == 0) continue;
      const auto* of_row = find(result_.training, t.row);
      const runs::PooledTraining* f = of_row != nullptr ? find(*of_row, t.task) : nullptr;
      if (f == nullptr) {
        table.add_missing({t.name, t.published});
        continue;
      }
      table.cells.push_back(
          {t.name, t.published, text_of("%.0f", f->env_steps),
           f->seconds_to_maximum ? text_of("%.0f", *f->seconds_to_maximum) : "had not converged",
           or_dash("%.0f", f->processor_seconds_to_maximum), text_of("%.0f", f->train_seconds),
           text_of("%.0f", f->processor_seconds), text_of("%.0f", f->env_steps / f->processor_seconds),
           text_of("%.0f %%", 100.0 * f->success_rate),
           std::to_string(f->n_converged) + " of " + std::to_string(f->origin.n_seeds)});
      charts += return_chart(std::string("fig4-") + t.row + "-" + t.task, t.name, {{t.name, prefix}});
    }
    if (table.cells.empty()) return;
    markdown_ += "Table I, training on one thread\n\n" + table.markdown() + "\n";
    page_.add_section(
        "training", "Table I and Fig. 4: training",
        "<p>One thread, evaluations included, on the clock and of the processor: the clock also counts what "
        "other cells and programs took of "
        "the machine meanwhile. Time to maximum: until the evaluation return, smoothed over five "
        "evaluations, was within 5 % of its rise below "
        "its maximum; given only where no seed's return rose by more than that in its last fifth. The "
        "paper's hours are its Table I, on its own "
        "machine, where three environments took 700 steps/s, 233 times as many as its rig (3 Hz).</p>" +
            table.html() +
            figure("<div class=\"two\">" + charts + "</div>",
                   "<b>Fig. 4.</b> Return of fixed evaluation episodes in the simulator that the policy "
                   "learns in: mean over seeds, dashed two standard deviations around it."));
  }

  void dynamics() {
    Table table{{"learned simulator", "paper: validation and test loss", "validation loss", "test loss",
                 "one step, position RMS (mm)", "heading RMS (degrees)", "seeds"}};
    table.text_columns = 1;
    for (const auto& [key, name, published] :
         {std::tuple{"paper", "as the paper's", "0.033, 0.045"},
          {"ReLU on the input", "the same, with ReLU on its input", "–"},
          {"best", "ours (its loss is a negative log-likelihood)", "–"}}) {
      const runs::PooledDynamics* f = find(result_.dynamics, key);
      if (f == nullptr) {
        table.add_missing({name, published});
        continue;
      }
      table.cells.push_back({name, published, text_of("%.3f", f->validation_loss),
                             text_of("%.3f", f->test_loss), text_of("%.2f", f->position_rms_mm),
                             or_dash("%.1f", f->heading_rms_deg), seeds_text(f->origin)});
    }
    std::string data;
    for (const auto& [id, name] :
         {std::pair{"data/paper", "the paper's way"}, {"data/best", "our explorer"}}) {
      const auto found = kept_.records.find(id);
      if (found == kept_.records.end() || !found->second.collected) continue;
      const runs::CollectionFacts& facts = *found->second.collected;
      data += std::to_string(facts.transitions) + " pulses " + name + ", " +
              std::to_string(facts.placements.value_or(0)) + " placements of the needle by hand. ";
    }
    markdown_ +=
        "Section V-A, recordings and learned simulators\n\n" + data + "\n\n" + table.markdown() + "\n";
    page_.add_section("dynamics", "Section V-A: recordings and learned simulators",
                      "<p>" + escape(data) + "</p>" + table.html());
  }

  /// Fig. 2: where the needle does not come, and where it goes too far or not at all.
  void zones() {
    std::string panels;
    for (const auto& [id, name] :
         {std::pair{"data/paper", "the paper's way"}, {"data/best", "our explorer"}}) {
      const auto found = kept_.records.find(id);
      if (found == kept_.records.end() || !found->second.mobility) continue;
      const data::Mobility& mobility = *found->second.mobility;
      std::vector<MapCell> moved, ways;
      std::size_t empty = 0;
      for (const data::MobilityCell& cell : mobility.cells) {
        if (cell.pulses == 0) {
          ++empty;
          continue;
        }
        moved.push_back({1e3 * cell.x_m, 1e3 * cell.y_m, 100.0 * cell.moved});
        ways.push_back({1e3 * cell.x_m, 1e3 * cell.y_m, cell.mean_mm});
      }
      const auto draw = [&](const std::vector<MapCell>& cells, double high, const char* legend,
                            const std::string& file) {
        DishSvg svg(1e3 * mobility.workspace_radius_m);
        svg.map(cells, 1e3 * mobility.cell_m, 0.0, high, legend, 0);
        const std::string drawn = svg.svg(std::string(legend) + ", recorded " + name);
        drawings_.emplace_back(file, drawn);
        return drawn;
      };
      const std::string suffix = std::string(id).substr(5);
      panels += "<div class=\"panel\">" +
                draw(moved, 100.0, "pulses that move it, %", "zones_moved_" + suffix) + "<b>" + escape(name) +
                "</b><br>share of pulses of at least " + text_of("%.1f A", mobility.strong_A) +
                " that moved the needle; " + std::to_string(empty) + " of " +
                std::to_string(mobility.cells.size()) + " squares had none</div>" + "<div class=\"panel\">" +
                draw(ways, 30.0, "mean way of a pulse, mm", "zones_way_" + suffix) + "<b>" + escape(name) +
                "</b><br>how far they took it</div>";
    }
    if (panels.empty()) return;
    page_.add_section("zones", "Fig. 2: control zones",
                      figure("<div class=\"panels\">" + panels + "</div>",
                             "<b>Fig. 2.</b> Zones as recorded, in squares of 4 mm by where a pulse began. "
                             "White: the needle was never there (the "
                             "paper's zones A, behind and between the coils). The paper's zone B is where "
                             "pulses move it, but not far."));
  }

  void mixes() {
    Table table{{"environments that replay", "final return", "success in the MBS", "steps", "seeds"}};
    table.text_columns = 1;
    std::vector<std::pair<std::string, std::string>> lines;
    for (const char* k : {"0", "1", "2", "3", "offline"}) {
      const std::string prefix = std::string("mix/") + k;
      if (by_id_.count(prefix) == 0) continue;
      const bool offline = std::string(k) == "offline";
      const std::string name = offline ? "recorded steps alone, our learner" : std::string(k) + " of 3";
      if (!offline) lines.emplace_back(name, prefix);
      add_training(table, {name}, find(result_.mixes, k));
    }
    if (table.cells.empty()) return;
    markdown_ += "Fig. 5, mixes with recorded pseudo-episodes\n\n" + table.markdown() + "\n";
    page_.add_section(
        "mixes", "Fig. 5: off-policy mixes",
        "<p>Of the paper's three environments, so many play back recorded stretches of 10 to 15 steps. "
        "Evaluated in the MBS, without them.</p>" +
            table.html() +
            figure(return_chart("fig5", "Return over steps", lines),
                   "<b>Fig. 5.</b> Mean over seeds, dashed two standard deviations around it."));
  }

  /// What the paper does not say, as it was chosen and otherwise.
  void open_choices() {
    Table table{{"what the paper leaves open", "choice", "final return", "success in the MBS",
                 "centre on unseen rigs, mean (95 % interval) (mm)", "success there", "seeds"}};
    const auto add = [&](const char* what, const std::string& choice, const runs::PooledTraining* training,
                         const runs::PooledErrors* trials) {
      if (training == nullptr) return table.add_missing({what, choice});
      table.cells.push_back({what, choice, text_of("%.2f", training->final_return),
                             text_of("%.0f %%", 100.0 * training->success_rate),
                             trials ? error_text(*trials) : "–", trials ? success_text(*trials) : "–",
                             seeds_text(training->origin)});
    };
    const auto* paper = find(result_.training, "paper");
    const runs::PooledTraining* ours = paper != nullptr ? find(*paper, "centre") : nullptr;
    const runs::PooledErrors* ours_driven = errors("paper", "bare", "centre");
    const auto other = [&](const char* what, const std::string& choice, const std::string& key) {
      const auto* trials = find(result_.open_choices, key);
      add(what, choice, find(result_.open_trainings, key),
          trials != nullptr ? find(*trials, "centre") : nullptr);
    };
    add("unit of the distance in the reward",
        "dish radii (ours: rewards then stay within -5 to 10, as the paper says)", ours, ours_driven);
    other("", "mm", "reward in mm");
    other("", "m", "reward in m");
    add("activation of the first layer", "none on the input itself (ours)", ours, ours_driven);
    other("", "ReLU on the normalised input, too", "ReLU on the input");
    for (const char* k : {"1", "3"}) {
      add("recorded episodes of under 10 steps", std::string("left out (ours), ") + k + " of 3 replay",
          find(result_.mixes, k), nullptr);
      other("", std::string("played as a whole, ") + k + " of 3 replay",
            std::string("short episodes kept, ") + k + " of 3");
    }
    markdown_ += "What the paper leaves open\n\n" + table.markdown() + "\n";
    page_.add_section("open", "What the paper leaves open",
                      "<p>Returns with distances in other units are on other scales: compare success and "
                      "what the policy does on unseen "
                      "rigs, bare.</p>" +
                          table.html());
  }

  void ablations() {
    Table table{{"our TD3 for points with one change", "point, mean (95 % interval) (mm)", "point, success",
                 "square, mean (95 % interval) (mm)", "square, success", "trials of each", "seeds"}};
    table.text_columns = 1;
    std::size_t few = 0;
    std::vector<std::string> names;
    for (const auto& [name, tasks] : result_.ablations)
      if (name != "best preset") names.push_back(name);
    if (result_.ablations.count("best preset") > 0) names.insert(names.begin(), "best preset");
    for (const std::string& name : names) {
      const auto& tasks = result_.ablations.at(name);
      const runs::PooledErrors *point = find(tasks, "point"), *square = find(tasks, "square");
      if (point == nullptr || square == nullptr) continue;
      if (point->n_trials < kEnoughTrials || point->origin.n_seeds < kEnoughSeeds) ++few;
      table.cells.push_back({name, error_text(*point), success_text(*point), error_text(*square),
                             success_text(*square), std::to_string(point->n_trials),
                             seeds_text(point->origin)});
    }
    if (table.cells.empty()) return;
    const std::string warning =
        few == 0
            ? ""
            : std::to_string(few) + " of these rows have fewer than " + std::to_string(kEnoughTrials) +
                  " trials or " + std::to_string(kEnoughSeeds) + " seeds: no sentence can be built on them.";
    markdown_ += "Ablations of our TD3, random target\n\n" + (warning.empty() ? "" : warning + "\n\n") +
                 table.markdown() + "\n";
    page_.add_section("ablations", "Ablations",
                      "<p>Each row changes one thing, and is trained as long as the row named best preset. "
                      "Unseen rigs, by camera, bare. " +
                          escape(warning) + "</p>" + table.html());
  }

  void origins() {
    std::vector<std::vector<std::string>> cells;
    for (const runs::Cell& cell : kept_.plan.cells) {
      const auto found = kept_.records.find(cell.id);
      if (found == kept_.records.end()) {
        cells.push_back({escape(cell.id), kMissing, "", "", "", ""});
        continue;
      }
      const runs::CellRecord& record = found->second;
      const auto told = [&](const char* key) {
        return record.machine.is_object() && record.machine.contains(key) && record.machine[key].is_string()
                   ? escape(record.machine[key].get<std::string>())
                   : std::string("–");
      };
      cells.push_back({escape(cell.id), escape(cell.config.empty() ? "–" : cell.config),
                       std::to_string(record.seed), told("git_commit"), told("processor"),
                       text_of("%.0f", record.seconds)});
    }
    page_.add_section("cells", "Where each cell comes from",
                      "<details><summary>" + std::to_string(cells.size()) + " cells</summary>" +
                          table({"cell", "preset", "seed", "commit", "processor", "time (s)"}, cells, 5) +
                          "</details>");
  }

  std::string write() {
    common::make_folders(folder_);
    common::write_artefact(folder_ + "/" + runs::PaperResult::kFile, result_);
    for (const auto& [name, drawing] : drawings_) write_svg(folder_ + "/images/" + name + ".svg", drawing);
    common::write_file_atomically(folder_ + "/table.md", markdown_);
    common::write_file_atomically(folder_ + "/report.html", page_.render());
    return markdown_;
  }

 private:
  const runs::PooledErrors* errors(const std::string& row, const std::string& variant,
                                   const std::string& task) const {
    const auto* of_row = find(result_.transfer, row);
    const auto* of_variant = of_row != nullptr ? find(*of_row, variant) : nullptr;
    return of_variant != nullptr ? find(*of_variant, task) : nullptr;
  }

  /// How the policy that does a task was trained.
  const runs::PooledTraining* training_of(const std::string& row, const std::string& task) const {
    if (row == "offline") return find(result_.mixes, "offline");
    const auto* of_row = find(result_.training, row);
    if (of_row == nullptr) return nullptr;
    const runs::PooledTraining* centre = task == "centre" ? find(*of_row, "centre") : nullptr;
    return centre != nullptr ? centre : find(*of_row, "target");
  }

  static void add_training(Table& table, std::vector<std::string> named, const runs::PooledTraining* f) {
    if (f == nullptr) return table.add_missing(std::move(named));
    named.insert(named.end(), {text_of("%.2f", f->final_return), text_of("%.0f %%", 100.0 * f->success_rate),
                               text_of("%.0f", f->env_steps), seeds_text(f->origin)});
    table.cells.push_back(std::move(named));
  }

  /// The trials of the first seed that are kept for drawing; empty where there are none.
  std::string drawing(const SeedRecords& seeds, const Row& row, const std::string& variant,
                      const std::string& variant_name, const std::string& task) {
    for (const auto& [seed, record] : seeds.found) {
      const auto& drawn = record->trials->drawn;
      if (drawn.empty()) continue;
      const std::vector<Trial> trials = read_trials(drawn);
      std::string svg = draw_trials(select(trials, task, record->trials->controller), kDishRadius_mm,
                                    "Trajectories: " + task + ", " + row.name + ", " + variant_name);
      drawings_.emplace_back(std::string(row.key) + "_" + variant + "_" + task, svg);
      return "<div class=\"panel\">" + svg + "<b>" + escape(task) + "</b><br>" + escape(row.name) + ", " +
             escape(variant_name) + "</div>";
    }
    return "";
  }

  /// Mean evaluation return over steps with two standard deviations, for each named group of seeds.
  std::string return_chart(const std::string& id, const std::string& title,
                           const std::vector<std::pair<std::string, std::string>>& lines) const {
    static const char* const kColours[] = {kPolicyColour, kBaselineColour, kSecondColour, "#7b4ea3"};
    LineChart chart{id, title, "environment steps", "return"};
    chart.small = lines.size() == 1;
    std::size_t colour = 0;
    for (const auto& [name, prefix] : lines) {
      std::map<double, std::vector<double>> by_step;
      for (const auto& [seed, record] : by_id_.at(prefix)->found) {
        if (!record->curve) continue;
        for (std::size_t i = 0; i < record->curve->env_steps.size(); ++i)
          by_step[record->curve->env_steps[i]].push_back(record->curve->episode_return[i]);
      }
      const char* const its_colour = kColours[colour++ % 4];
      LineSeries middle{name, {}, its_colour};
      LineSeries low{name + ", - 2 std", {}, its_colour, /*dashed=*/true};
      LineSeries high{name + ", + 2 std", {}, its_colour, /*dashed=*/true};
      bool several = false;
      for (const auto& [step, values] : by_step) {
        const double centre = common::mean(values);
        const double spread = common::standard_deviation(values);
        several = several || values.size() > 1;
        middle.points.emplace_back(step, centre);
        low.points.emplace_back(step, centre - 2.0 * spread);
        high.points.emplace_back(step, centre + 2.0 * spread);
      }
      if (middle.points.empty()) continue;
      chart.series.push_back(middle);
      if (several) chart.series.insert(chart.series.end(), {low, high});
    }
    return chart.series.empty() ? "" : chart_html(chart);
  }

  const runs::KeptPlan& kept_;
  std::vector<std::pair<std::string, SeedRecords>> groups_;
  std::map<std::string, const SeedRecords*> by_id_;
  runs::PaperResult result_;
  std::string folder_;
  HtmlPage page_;
  std::vector<std::pair<std::string, std::string>> drawings_;  ///< name of the file, drawing
  std::string markdown_;
};

}  // namespace

std::string write_paper_report(const runs::KeptPlan& kept, const std::string& folder) {
  PaperReport report(kept, folder);
  report.summary();
  report.transfer();
  report.training();
  report.dynamics();
  report.zones();
  report.mixes();
  report.open_choices();
  report.ablations();
  report.origins();
  return report.write();
}

}  // namespace lodestone::report
