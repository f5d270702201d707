#include "lodestone/report/paper_report.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <optional>
#include <vector>

#include "lodestone/common/artefact.h"
#include "lodestone/common/build_facts.h"
#include "lodestone/common/files.h"
#include "lodestone/common/statistics.h"
#include "lodestone/report/charts.h"
#include "lodestone/report/html.h"
#include "lodestone/report/html_page.h"
#include "lodestone/report/run_data.h"
#include "lodestone/runs/curves.h"
#include "lodestone/runs/paper_result.h"
#include "lodestone/runs/run_folder.h"
#include "trial_drawing.h"

namespace lodestone::report {
namespace {

namespace fs = std::filesystem;
using common::Interval;

constexpr double kDishRadius_mm = 42.5;

/// A row of table II: what drives, and what the paper measured with it.
struct Row {
  const char* key;
  const char* name;
  std::map<std::string, const char*> paper;
};

const std::vector<Row>& rows() {
  static const std::vector<Row> kRows = {
      {"simulator", "TD3 in the plain simulator", {{"centre", "31 ± 29"}}},
      {"randomised", "TD3 in the randomised simulator", {}},
      {"paper",
       "TD3 in an MBS, paper's preset",
       {{"centre", "6.3 ± 2.1"}, {"point", "5.3 ± 0.8"}, {"square", "7.4 ± 0.7"}}},
      {"best", "TD3 in an MBS, best preset", {}},
      {"turning", "best preset for points, then turning in place", {}},
      {"planner", "planner in the MBS", {}},
      {"baseline", "proportional baseline", {}},
      {"offline", "TD3 on recorded steps alone", {}}};
  return kRows;
}

/// The folders of a cell's training seeds whose runs are finished, by number.
std::vector<std::string> seeds_of(const std::string& folder) {
  std::map<int, std::string> found;
  if (fs::is_directory(folder)) {
    for (const auto& entry : fs::directory_iterator(folder)) {
      const std::optional<runs::RunState> run = runs::find_run(entry.path().string());
      if (run && run->finished) found[std::atoi(entry.path().filename().c_str())] = entry.path().string();
    }
  }
  std::vector<std::string> out;
  for (const auto& [number, path] : found) out.push_back(path);
  return out;
}

/// Errors of one task under one controller, by training seed: the distance at the end of a trial, or the
/// cross-track RMS of one.
struct Errors {
  std::vector<std::vector<double>> by_seed_mm;
  std::int64_t successes = 0;
  std::int64_t stopped = 0;
  std::vector<runs::TrialFigures> figures;      ///< of every trial
  std::vector<runs::TrialRecord> first_trials;  ///< of the first seed

  std::vector<double> all() const {
    std::vector<double> out;
    for (const auto& seed : by_seed_mm) out.insert(out.end(), seed.begin(), seed.end());
    return out;
  }
  std::int64_t trials() const { return static_cast<std::int64_t>(all().size()); }
};

std::optional<Errors> read_errors(const std::string& folder) {
  Errors errors;
  for (const std::string& seed : seeds_of(folder)) {
    auto trials = runs::find_trials(seed);
    if (!trials) continue;
    std::vector<double> values;
    for (const runs::TrialRecord& trial : *trials) {
      const runs::TrialFigures& figures = trial.figures();
      values.push_back(figures.error_mm());
      errors.figures.push_back(figures);
      errors.successes += figures.success ? 1 : 0;
      errors.stopped += trial.completed ? 0 : 1;
    }
    errors.by_seed_mm.push_back(std::move(values));
    if (errors.first_trials.empty()) errors.first_trials = std::move(*trials);
  }
  if (errors.trials() == 0) return std::nullopt;
  return errors;
}

/// The values of a figure in the trials that have it.
std::vector<double> values_of(const Errors& errors, std::optional<double> runs::TrialFigures::*figure) {
  std::vector<double> values;
  for (const runs::TrialFigures& trial : errors.figures)
    if (trial.*figure) values.push_back(*(trial.*figure));
  return values;
}

void pool_path_figures(const Errors& errors, runs::PooledErrors& out) {
  using Figures = runs::TrialFigures;
  const auto mean = [&](std::optional<double> Figures::*figure) -> std::optional<double> {
    const std::vector<double> values = values_of(errors, figure);
    return values.empty() ? std::nullopt : std::optional(common::mean(values));
  };
  out.target_deviation_mm = mean(&Figures::target_deviation_mm);
  if (out.target_deviation_mm)
    out.target_deviation_std_mm =
        common::standard_deviation(values_of(errors, &Figures::target_deviation_mm));
  out.time_rms_error_mm = mean(&Figures::time_rms_error_mm);
  out.completion = mean(&Figures::completion);
  out.corners_reached = mean(&Figures::corners_reached);
  out.frechet_mm = mean(&Figures::frechet_mm);
}

runs::PooledErrors pooled(const Errors& errors) {
  const std::vector<double> all = errors.all();
  runs::PooledErrors out;
  out.mean_error_mm = common::mean(all);
  out.std_error_mm = common::standard_deviation(all);
  out.rms_error_mm = common::root_mean_square(all);
  out.iqm_error_mm = common::interquartile_mean(all);
  const Interval iqm = common::bootstrap_interval(errors.by_seed_mm, common::interquartile_mean,
                                                  common::RandomStream(1, "bootstrap"));
  out.iqm_interval_mm = {iqm.low, iqm.high};
  out.n_trials = errors.trials();
  out.success_rate = static_cast<double>(errors.successes) / static_cast<double>(out.n_trials);
  const Interval success = common::wilson_interval(errors.successes, out.n_trials);
  out.success_interval = {success.low, success.high};
  pool_path_figures(errors, out);
  out.n_stopped = errors.stopped;
  out.n_seeds = static_cast<std::int64_t>(errors.by_seed_mm.size());
  return out;
}

std::string cell_text(const char* format, double a, double b = 0.0, double c = 0.0) {
  char buffer[96];
  std::snprintf(buffer, sizeof buffer, format, a, b, c);
  return buffer;
}

std::string iqm_text(const runs::PooledErrors& e) {
  return cell_text("%.2f (%.2f to %.2f)", e.iqm_error_mm, e.iqm_interval_mm[0], e.iqm_interval_mm[1]);
}
std::string success_text(const runs::PooledErrors& e) {
  return cell_text("%.0f %% (%.0f to %.0f)", 100.0 * e.success_rate, 100.0 * e.success_interval[0],
                   100.0 * e.success_interval[1]);
}

/// Of points the same as the error.
std::string deviation_text(const runs::PooledErrors& e) {
  return cell_text("%.2f ± %.2f", e.target_deviation_mm.value_or(e.mean_error_mm),
                   e.target_deviation_std_mm.value_or(e.std_error_mm));
}

std::string or_dash(const char* format, const std::optional<double>& value, double scale = 1.0) {
  return value ? cell_text(format, scale * *value) : "–";
}

/// A table as HTML, Markdown and JSON at once.
struct Table {
  std::vector<std::string> headers;
  std::vector<std::vector<std::string>> cells;
  int text_columns = 2;

  std::string html() const {
    std::vector<std::vector<std::string>> escaped = cells;
    for (auto& row : escaped) {
      for (std::string& cell : row) cell = escape(cell);
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

/// Everything the report says, gathered part by part.
class PaperReport {
 public:
  PaperReport(std::string folder, const std::string& scale)
      : cells_(folder + "/cells"),
        folder_(std::move(folder)),
        page_("The paper's experiments, on the virtual rig",
              "Section V beside ours, scale " + scale +
                  ": every figure of ours is measured against the true pose on "
                  "virtual rigs that no training saw; the paper's are from its real rig") {
    result_.scale = scale;
    result_.machine = common::build_and_host_facts();
    result_.machine.erase("host");
    result_.machine.erase("system");
  }

  void transfer() {
    Table table;
    table.headers = {"task",
                     "controller",
                     "paper, deviation from the targets (mm)",
                     "deviation from the targets (mm)",
                     "error, mean ± std (mm)",
                     "error, IQM (95 % interval) (mm)",
                     "RMS in time (mm)",
                     "completion",
                     "corners reached",
                     "success (95 % interval)",
                     "trials",
                     "seeds",
                     "stopped early"};
    std::string drawings;
    for (const char* task : {"centre", "point", "square", "pose"}) {
      for (const Row& row : rows()) {
        const auto errors = read_errors(cells_ + "/transfer/" + row.key + "/" + task);
        if (!errors) continue;
        const runs::PooledErrors f = pooled(*errors);
        result_.transfer[row.key][task] = f;
        const auto paper = row.paper.find(task);
        table.cells.push_back(
            {task, row.name, paper == row.paper.end() ? "–" : paper->second, deviation_text(f),
             cell_text("%.2f ± %.2f", f.mean_error_mm, f.std_error_mm), iqm_text(f),
             or_dash("%.2f", f.time_rms_error_mm), or_dash("%.0f %%", f.completion, 100.0),
             or_dash("%.0f %%", f.corners_reached, 100.0), success_text(f), std::to_string(f.n_trials),
             std::to_string(f.n_seeds), std::to_string(f.n_stopped)});
        const std::string drawing = draw_trials(
            select(read_trials(errors->first_trials), task, errors->first_trials.front().controller),
            kDishRadius_mm,
            "Trajectories: " + std::string(task) + ", " + errors->first_trials.front().controller);
        drawings_.emplace_back(std::string(row.key) + "_" + task, drawing);
        drawings += "<div class=\"panel\">" + drawing + "<b>" + escape(task) + "</b><br>" + escape(row.name) +
                    "</div>";
      }
    }
    if (table.cells.empty()) return;
    markdown_ += "Table II, transfer to unseen rigs by camera\n\n" + table.markdown() + "\n";
    page_.add_section(
        "transfer", "Table II and Fig. 6: transfer",
        "<p>Starts, targets, friction maps, temperatures and cameras are the same for every row, and were "
        "not used for any choice. Deviation from the targets, the paper's measure: of points the distance at "
        "the end of a trial of 20 s, of the square the mean distance to the target that is fed at the time. "
        "Error: of points the same, of the square the cross-track RMS of a trial. Completion: share of the "
        "square's points that the needle came within 3 mm of, in order, within 3 s of their time. Success: "
        "within 3 mm (pose: and 15 degrees); of the square a completion of 95 %, every corner within 3 mm, "
        "and a cross-track RMS within 3 mm. A trial that was stopped is scored with the needle where it lay. "
        "The simulators' policies, the best preset, the planner and the baseline have the same "
        "adaptive gain and hold around them; the paper's preset has nothing.</p>" +
            table.html() +
            figure("<div class=\"panels\">" + drawings + "</div>",
                   "<b>Fig. 6.</b> True trajectories of one training seed on unseen rigs."));
  }

  void training() {
    Table table;
    table.headers = {"policy", "paper", "wall-clock to 95 % of the final return (s)", "whole training (s)",
                     "seeds"};
    std::string charts;
    struct Trained {
      const char *row, *task, *name, *paper;
    };
    for (const Trained& t :
         std::initializer_list<Trained>{{"paper", "centre", "MBS, paper's preset, centre", "1.5 h"},
                                        {"paper", "target", "MBS, paper's preset, random target", "3.5 h"},
                                        {"simulator", "centre", "plain simulator, centre", "5.5 h"},
                                        {"simulator", "target", "plain simulator, random target", "27 h"},
                                        {"randomised", "centre", "randomised simulator, centre", "–"},
                                        {"randomised", "target", "randomised simulator, random target", "–"},
                                        {"best", "centre", "MBS, best preset, centre", "–"},
                                        {"best", "target", "MBS, best preset, random target", "–"},
                                        {"best", "pose", "MBS, best preset, pose", "–"}}) {
      const std::string folder = cells_ + "/policy/" + t.row + "/" + t.task;
      std::vector<double> to_fraction_s;
      std::vector<double> whole_s;
      for (const std::string& seed : seeds_of(folder)) {
        const auto result = common::find_artefact<runs::PolicyResult>(seed + "/" + runs::PolicyResult::kFile);
        if (!result) continue;
        to_fraction_s.push_back(result->seconds_to_95_percent);
        whole_s.push_back(result->train_seconds);
      }
      if (to_fraction_s.empty()) continue;
      result_.training[t.row][t.task] = {common::mean(to_fraction_s), common::mean(whole_s),
                                         static_cast<std::int64_t>(to_fraction_s.size())};
      table.cells.push_back(
          {t.name, t.paper,
           cell_text("%.1f ± %.1f", common::mean(to_fraction_s), common::standard_deviation(to_fraction_s)),
           cell_text("%.1f ± %.1f", common::mean(whole_s), common::standard_deviation(whole_s)),
           std::to_string(to_fraction_s.size())});
      const std::string chart =
          return_chart(std::string("fig4-") + t.row + "-" + t.task, t.name, {{t.name, folder}});
      if (!chart.empty()) charts += chart;
    }
    if (table.cells.empty()) return;
    markdown_ +=
        "Table I, training time on one thread, beside other cells and whatever else the machine did\n\n" +
        table.markdown() + "\n";
    page_.add_section(
        "training", "Table I and Fig. 4: training",
        "<p>Time of learning on one thread, beside other cells and whatever else the machine did, "
        "evaluations included. The paper's hours are its Table I, on "
        "its own machine.</p>" +
            table.html() +
            figure("<div class=\"two\">" + charts + "</div>",
                   "<b>Fig. 4.</b> Return of fixed evaluation episodes in the simulator that the policy "
                   "learns in: mean over seeds, dashed two standard deviations around it."));
  }

  void mixes() {
    std::vector<std::pair<std::string, std::string>> lines;
    Table table;
    table.headers = {"environments that replay", "final return, mean ± std", "success in the MBS", "seeds"};
    table.text_columns = 1;
    for (const char* k : {"0", "1", "2", "3", "offline"}) {
      const std::string folder = cells_ + "/mix/" + k;
      std::vector<double> returns;
      std::vector<double> success;
      for (const std::string& seed : seeds_of(folder)) {
        const auto metrics = read_lines(seed + "/metrics.jsonl");
        const Curve r = curve(metrics, runs::curves::kReturn);
        const Curve s = curve(metrics, runs::curves::kSuccess);
        if (r.empty() || s.empty()) continue;
        returns.push_back(r.back().second);
        success.push_back(s.back().second);
      }
      if (returns.empty()) continue;
      const bool offline = std::string(k) == "offline";
      const std::string name = offline ? "recorded steps alone, best learner" : std::string(k) + " of 3";
      result_.mixes[k] = {common::mean(returns), common::mean(success),
                          static_cast<std::int64_t>(returns.size())};
      table.cells.push_back(
          {name, cell_text("%.2f ± %.2f", common::mean(returns), common::standard_deviation(returns)),
           cell_text("%.0f %%", 100.0 * common::mean(success)), std::to_string(returns.size())});
      if (!offline) lines.emplace_back(name, folder);
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

  void ablations() {
    if (!fs::is_directory(cells_ + "/ablation")) return;
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(cells_ + "/ablation"))
      names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end(), [](const std::string& a, const std::string& b) {
      return std::make_pair(a != "best_preset", a) < std::make_pair(b != "best_preset", b);
    });
    Table table;
    table.headers = {"best preset with one change",
                     "point, IQM (95 % interval) (mm)",
                     "point, mean (mm)",
                     "point, success",
                     "square, IQM (95 % interval) (mm)",
                     "square, mean (mm)",
                     "square, success",
                     "trials"};
    table.text_columns = 1;
    for (const std::string& name : names) {
      const auto point = read_errors(cells_ + "/ablation/" + name + "/point");
      const auto square = read_errors(cells_ + "/ablation/" + name + "/square");
      if (!point || !square) continue;
      const runs::PooledErrors p = pooled(*point);
      const runs::PooledErrors s = pooled(*square);
      std::string shown = name;
      std::replace(shown.begin(), shown.end(), '_', ' ');
      result_.ablations[shown] = {{"point", p}, {"square", s}};
      table.cells.push_back({shown, iqm_text(p), cell_text("%.2f", p.mean_error_mm), success_text(p),
                             iqm_text(s), cell_text("%.2f", s.mean_error_mm), success_text(s),
                             std::to_string(p.n_trials)});
    }
    if (table.cells.empty()) return;
    markdown_ += "Ablations of the best preset, random target\n\n" + table.markdown() + "\n";
    page_.add_section(
        "ablations", "Ablations",
        "<p>Each row changes one thing in the best preset, and is trained as long as the row named best "
        "preset. Unseen rigs, by camera.</p>" +
            table.html());
  }

  std::string write() {
    common::write_artefact(folder_ + "/" + runs::PaperResult::kFile, result_);
    for (const auto& [name, drawing] : drawings_) write_svg(folder_ + "/images/" + name + ".svg", drawing);
    common::write_file_atomically(folder_ + "/table.md", markdown_);
    common::write_file_atomically(folder_ + "/report.html", page_.render());
    return markdown_;
  }

 private:
  /// Mean evaluation return over steps with two standard deviations, for each named folder of seeds.
  static std::string return_chart(const std::string& id, const std::string& title,
                                  const std::vector<std::pair<std::string, std::string>>& lines) {
    static const char* const kColours[] = {kPolicyColour, kBaselineColour, kSecondColour, "#7b4ea3"};
    LineChart chart{id, title, "environment steps", "return"};
    chart.small = lines.size() == 1;
    std::size_t colour = 0;
    for (const auto& [name, folder] : lines) {
      std::map<double, std::vector<double>> by_step;
      for (const std::string& seed : seeds_of(folder)) {
        for (const auto& [step, value] : curve(read_lines(seed + "/metrics.jsonl"), runs::curves::kReturn))
          by_step[step].push_back(value);
      }
      const char* const its_colour = kColours[colour++ % 4];
      LineSeries mean{name, {}, its_colour};
      LineSeries low{name + ", - 2 std", {}, its_colour, /*dashed=*/true};
      LineSeries high{name + ", + 2 std", {}, its_colour, /*dashed=*/true};
      for (const auto& [step, values] : by_step) {
        const double middle = common::mean(values);
        const double spread = common::standard_deviation(values);
        mean.points.emplace_back(step, middle);
        low.points.emplace_back(step, middle - 2.0 * spread);
        high.points.emplace_back(step, middle + 2.0 * spread);
      }
      if (mean.points.empty()) continue;
      for (LineSeries* series : {&mean, &low, &high}) chart.series.push_back(*series);
    }
    return chart.series.empty() ? "" : chart_html(chart);
  }

  std::string cells_;
  std::string folder_;
  HtmlPage page_;
  runs::PaperResult result_;
  std::vector<std::pair<std::string, std::string>> drawings_;  ///< name of the file, drawing
  std::string markdown_;
};

}  // namespace

std::string write_paper_report(const std::string& folder, const std::string& scale) {
  PaperReport report(folder, scale);
  report.transfer();
  report.training();
  report.mixes();
  report.ablations();
  return report.write();
}

}  // namespace lodestone::report
