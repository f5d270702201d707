#include "paper_page.h"

#include <algorithm>
#include <cstdio>

#include "lodestone/common/statistics.h"
#include "lodestone/report/charts.h"
#include "lodestone/report/html.h"

namespace lodestone::report {

std::string formatted(const char* format, double a, double b, double c) {
  char buffer[128];
  std::snprintf(buffer, sizeof buffer, format, a, b, c);
  return buffer;
}

std::string or_dash(const char* format, const std::optional<double>& value) {
  return value ? formatted(format, *value) : "–";
}

namespace {

/// Nothing where both are the same.
std::string range_text(const std::string& low, const std::string& high) {
  return low == high ? "" : " (" + low + " to " + high + ")";
}

}  // namespace

std::string with_interval(const char* format, const std::optional<double>& mean,
                          const std::optional<std::array<double, 2>>& interval) {
  const std::string text = or_dash(format, mean);
  if (!mean || !interval) return text;
  return text + range_text(formatted(format, (*interval)[0]), formatted(format, (*interval)[1]));
}

std::string error_text(const runs::PooledErrors& e) {
  return formatted("%.2f (%.2f to %.2f)", e.mean_error_mm, e.mean_interval_mm[0], e.mean_interval_mm[1]);
}

std::string success_text(const runs::PooledErrors& e) {
  return percent_text(e.success_rate, e.success_interval);
}

std::string percent_text(const std::optional<double>& share,
                         const std::optional<std::array<double, 2>>& interval) {
  if (!share) return "–";
  const auto percent = [](double value) { return formatted("%.0f", 100.0 * value); };
  return percent(*share) + " %" +
         (interval ? range_text(percent((*interval)[0]), percent((*interval)[1])) : "");
}

std::string success_text(const runs::PooledTraining& t) {
  return percent_text(t.success_rate, t.success_range);
}

std::string steps_to_maximum_text(const runs::PooledTraining& t) {
  if (!t.steps_to_maximum || !t.steps_to_maximum_range) return "had not converged";
  return grouped(*t.steps_to_maximum) +
         range_text(grouped((*t.steps_to_maximum_range)[0]), grouped((*t.steps_to_maximum_range)[1]));
}

std::string seeds_text(const runs::CellOrigin& origin) {
  return std::to_string(origin.n_seeds) + " of " + std::to_string(origin.n_seeds_planned);
}

std::string from_reference_text(const runs::PooledErrors& e) {
  if (!e.from_reference_mm || !e.from_reference_interval_mm) return "–";
  const std::string text = formatted("%+.2f (%+.2f to %+.2f)", *e.from_reference_mm,
                                     (*e.from_reference_interval_mm)[0], (*e.from_reference_interval_mm)[1]);
  return text + (e.n_shared_trials == e.n_trials ? "" : " on " + std::to_string(e.n_shared_trials));
}

std::string joined(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : ", ") + part;
  return text;
}

void add_new(std::vector<std::string>& list, const std::vector<std::string>& texts) {
  for (const std::string& text : texts)
    if (std::find(list.begin(), list.end(), text) == list.end()) list.push_back(text);
}

namespace {

std::string commits_text(const std::vector<std::string>& commits) {
  const std::string text = "Commits: " + joined(commits) + ".";
  const bool changed = text.find("+changes") != std::string::npos;
  return text + (changed ? " +changes: with changes that were not committed." : "");
}

}  // namespace

void PaperTable::add_commits(const runs::CellOrigin& origin) { add_new(commits, origin.commits); }

void PaperTable::add_missing(std::vector<std::string> named) {
  named.emplace_back(kMissing);
  named.resize(headers.size());
  cells.push_back(std::move(named));
}

std::string PaperTable::html() const {
  std::vector<std::vector<std::string>> escaped = cells;
  for (auto& row : escaped)
    for (std::size_t i = 0; i < row.size(); ++i) {
      row[i] = escape(row[i]);
      if (static_cast<int>(i) < text_columns) row[i] = "<span class=\"whole\">" + row[i] + "</span>";
    }
  return table(headers, escaped, text_columns) +
         (commits.empty() ? "" : "<p>" + escape(commits_text(commits)) + "</p>");
}

std::string PaperTable::markdown() const {
  const auto line = [](const std::vector<std::string>& row) {
    std::string out = "|";
    for (const std::string& cell : row) out += " " + cell + " |";
    return out + "\n";
  };
  std::string out = line(headers) + "|";
  for (std::size_t i = 0; i < headers.size(); ++i) out += " --- |";
  out += "\n";
  for (const auto& row : cells) out += line(row);
  return out + (commits.empty() ? "" : "\n" + commits_text(commits) + "\n");
}

PaperPage::PaperPage(const runs::KeptPlan& kept_plan, const runs::KeptPlan& paces)
    : kept(kept_plan),
      groups(by_prefix(kept)),
      result(paper_figures(kept, paces)),
      html("The paper's experiments, on the virtual rig",
           "Section V beside ours: every figure of ours is measured against the true pose on virtual rigs "
           "that no "
           "training saw; the paper's are from its real rig") {
  for (const auto& [prefix, seeds] : groups) by_id[prefix] = &seeds;
}

const runs::PooledErrors* PaperPage::errors(const std::string& row, const std::string& variant,
                                            const std::string& task) const {
  const auto* of_row = find(result.transfer, row);
  const auto* of_variant = of_row != nullptr ? find(*of_row, variant) : nullptr;
  return of_variant != nullptr ? find(*of_variant, task) : nullptr;
}

std::optional<runs::PooledTraining> PaperPage::training_of(const std::string& row, const std::string& task,
                                                           const SeedRecords& driven) const {
  std::vector<std::string> prefixes = {"policy/" + row + "/target"};
  if (task == "centre") prefixes.insert(prefixes.begin(), "policy/" + row + "/centre");
  if (row == "offline") prefixes = {"mix/offline"};
  for (const std::string& prefix : prefixes) {
    if (!planned(prefix)) continue;
    const SeedRecords seeds = with_seeds_of(*by_id.at(prefix), driven);
    return seeds.found.empty() ? std::nullopt : std::optional(pooled_training(seeds));
  }
  return std::nullopt;
}

void PaperPage::add_part(const std::string& id, const std::string& title, const std::string& note,
                         const std::vector<std::pair<std::string, PaperTable>>& titled_tables,
                         const std::string& html_below) {
  std::string text = "<p>" + escape(note) + "</p>";
  markdown += title + "\n\n" + note + "\n\n";
  for (const auto& [name, its] : titled_tables) {
    markdown += (name.empty() ? "" : name + "\n\n") + its.markdown() + "\n";
    text += (name.empty() ? "" : "<h3>" + escape(name) + "</h3>") + its.html();
  }
  html.add_section(id, title, text + html_below);
}

std::string PaperPage::return_chart(const std::string& id, const std::string& title,
                                    const std::vector<std::pair<std::string, std::string>>& lines) const {
  static const char* const kColours[] = {kPolicyColour, kBaselineColour, kSecondColour, "#7b4ea3"};
  LineChart chart{id, title, "environment steps", "return"};
  chart.small = lines.size() == 1;
  std::size_t colour = 0;
  for (const auto& [name, prefix] : lines) {
    std::map<double, std::vector<double>> by_step;
    for (const auto& [seed, record] : by_id.at(prefix)->found) {
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

}  // namespace lodestone::report
