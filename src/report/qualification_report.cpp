#include "lodestone/report/qualification_report.h"

#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "lodestone/common/artefact.h"
#include "lodestone/common/files.h"
#include "lodestone/report/charts.h"
#include "lodestone/report/html.h"
#include "lodestone/report/html_page.h"
#include "lodestone/runs/qualification_result.h"
#include "sections.h"

namespace lodestone::report {
namespace {

using runs::Measured;
using runs::QualificationResult;

std::string shown_figure(const Measured& figure, int decimals, double scale = 1.0) {
  std::string text = fixed(scale * figure.value, decimals);
  if (figure.interval)
    text += " (" + fixed(scale * figure.interval->at(0), decimals) + " to " +
            fixed(scale * figure.interval->at(1), decimals) + ")";
  return text;
}

std::string shown_figure(const std::optional<Measured>& figure, int decimals, double scale = 1.0) {
  return figure ? shown_figure(*figure, decimals, scale) : "–";
}

std::string share_of(std::int64_t part, std::int64_t all) {
  return all > 0 ? fixed(100.0 * static_cast<double>(part) / static_cast<double>(all), 1) + " %" : "–";
}

std::string verdict_table(const QualificationResult& result) {
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> classes;
  for (const runs::QualifiedItem& item : result.items) {
    rows.push_back({escape(item.item), escape(item.verdict), escape(item.why), fixed(item.value, 2),
                    fixed(item.good, 2), fixed(item.acceptable, 2), escape(item.unit)});
    classes.push_back(item.verdict == "mend" ? "strong" : "");
  }
  return table({"item", "verdict", "why these bounds", "measured", "good up to", "acceptable up to", "unit"},
               rows, 3, classes);
}

std::string still_rows(const QualificationResult& result) {
  std::vector<std::vector<std::string>> rows;
  const auto add = [&rows](const char* when, const std::optional<runs::StillFigures>& still) {
    if (!still) return;
    rows.push_back({when, shown_figure(still->x_mm, 3), shown_figure(still->y_mm, 3),
                    shown_figure(still->heading_deg, 3), shown_figure(still->whitened_position, 2),
                    shown_figure(still->whitened_heading, 2), shown_figure(still->drift_mm_per_min, 3),
                    std::to_string(still->x_mm.n), std::to_string(still->refused)});
  };
  add("at the beginning", result.still);
  add("at the end", result.still_at_end);
  return table({"", "x (mm)", "y (mm)", "heading (degrees)", "position by its reported spread",
                "heading by its reported spread", "drift (mm/min)", "looks", "refused"},
               rows, 1);
}

std::string refusal_map(const QualificationResult& result, DrawnRig rig) {
  std::vector<MapCell> cells;
  for (const runs::RefusalBin& bin : result.refusals->cells)
    if (bin.looks > 0)
      cells.push_back(
          {bin.x_mm, bin.y_mm, 100.0 * static_cast<double>(bin.refused) / static_cast<double>(bin.looks)});
  double most = 1.0;
  for (const MapCell& cell : cells) most = std::max(most, cell.value);
  rig.radius_mm = result.dish_radius_mm;
  DishSvg dish(rig);
  dish.map(cells, result.refusals->cell_mm, 0.0, most, "looks without a pose (%)", 0);
  return dish.svg("Share of looks without a pose over the dish");
}

std::string refusals_section(const QualificationResult& result, const DrawnRig& rig) {
  const runs::RefusalFigures& refusals = *result.refusals;
  std::vector<std::vector<std::string>> headings, reasons;
  for (const runs::RefusalBin& bin : refusals.headings)
    headings.push_back(
        {fixed(bin.heading_from_deg, 0) + " to " + fixed(bin.heading_from_deg + refusals.heading_bin_deg, 0),
         share_of(bin.refused, bin.looks), std::to_string(bin.looks)});
  for (const auto& [reason, count] : refusals.reasons)
    reasons.push_back({escape(reason), std::to_string(count)});
  return "<p>" + shown_figure(refusals.share, 1, 100.0) + " % of " + std::to_string(refusals.share.n) +
         " looks while the needle was driven gave no pose.</p>" +
         figure(refusal_map(result, rig),
                "<b>Looks without a pose over the dish</b>, in squares of " + fixed(refusals.cell_mm, 1) +
                    " mm. White: the needle was never there. A look without a pose counts where the needle "
                    "was seen next.") +
         table({"heading (degrees)", "without a pose", "looks"}, headings, 1) +
         (reasons.empty() ? "" : table({"reason", "looks"}, reasons, 1));
}

std::string qualified_coils(const QualificationResult& result) {
  std::vector<std::vector<std::string>> rows;
  for (const runs::CoilFigures& coil : result.coils)
    rows.push_back({escape(coil.name), shown_figure(coil.gain, 3), shown_figure(coil.rise_ms, 1),
                    shown_figure(coil.skew_ms, 1), shown_figure(coil.gain_by_motion, 2),
                    fixed(coil.first_C, 1), fixed(coil.last_C, 1),
                    coil.gain ? std::to_string(coil.gain->n) : "–", escape(coil.why)});
  return figure(table({"coil", "gain", "10 to 90 % (ms)", "later than the mean at 50 % (ms)",
                       "gain by motion", "at first (C)", "at last (C)", "pulses", "not measured"},
                      rows, 1),
                "Gain, rise and skew are of the currents that the coils report. By motion: how weak a pulse "
                "moves the needle at the dish centre, beside the mean coil; coarse, as friction is uneven.");
}

std::string motion_section(const QualificationResult& result) {
  std::vector<std::vector<std::string>> rows;
  const auto add = [&rows](const std::string& what, const std::optional<Measured>& figure, int decimals,
                           double scale, const char* unit) {
    rows.push_back(
        {what, shown_figure(figure, decimals, scale), unit, figure ? std::to_string(figure->n) : "0"});
  };
  if (result.latency)
    add("from a pulse to motion, by looks every " + fixed(result.latency->resolution_ms, 1) +
            " ms at shifted times; not seen: " + std::to_string(result.latency->unseen),
        result.latency->ms, 1, 1.0, "ms");
  if (result.same_pulse) {
    const runs::SamePulseFigures& same = *result.same_pulse;
    add("step of the same pulse", same.step_mm, 2, 1.0, "mm");
    add("its scatter per axis", same.all_mm, 2, 1.0, "mm");
    add("that the starts do not explain (they explain " + fixed(100.0 * same.explained, 0) + " %)",
        same.scatter_mm, 2, 1.0, "mm");
  }
  add("change of that step to the end", result.step_change, 1, 100.0, "%");
  if (result.stick_slip) {
    add("weakest current that moves the needle, over places", result.stick_slip->current_A, 2, 1.0, "A");
    add("its spread over places", result.stick_slip->spread, 0, 100.0, "%");
  }
  std::string html = table({"", "(95 % interval)", "unit", "n"}, rows, 1);
  if (!result.stick_slip) return html;
  std::vector<std::vector<std::string>> places;
  for (const runs::BreakawayPlace& place : result.stick_slip->places)
    places.push_back(
        {fixed(place.x_mm, 1), fixed(place.y_mm, 1),
         place.current_A ? fixed(place.current_A, 2) : "more than " + fixed(place.tried_up_to_A, 2),
         std::to_string(place.pulses)});
  html += table({"x (mm)", "y (mm)", "moves it from (A)", "pulses"}, places, 0);
  LineChart chart{"steps", "Weak pulses: what they do, and how it scatters", "current (A)", "mm"};
  chart.from_zero = true;
  LineSeries step{"step", {}, kPolicyColour};
  LineSeries scatter{"scatter per axis", {}, kBaselineColour};
  for (const runs::StepLevel& level : result.stick_slip->levels) {
    step.points.emplace_back(level.current_A, level.step_mm);
    scatter.points.emplace_back(level.current_A, level.scatter_mm);
  }
  if (step.points.empty()) return html;
  chart.series = {std::move(step), std::move(scatter)};
  return html + figure(chart_html(chart),
                       "The scatter is what the heading before a pulse does not explain, less the sensor's "
                       "part.");
}

/// The best that is known of it: by true poses, where the still needle was measured.
const std::optional<Measured>& expected_mm(const runs::PointsFigures& points) {
  return points.rms_mm ? points.rms_mm : points.sensed_rms_mm;
}

std::string points_section(const runs::PointsFigures& points) {
  const std::vector<std::vector<std::string>> rows = {
      {"RMS of the distance at the end, as true poses would show it", shown_figure(points.rms_mm, 3), "mm"},
      {"RMS as it was sensed", shown_figure(points.sensed_rms_mm, 3), "mm"},
      {"95 % were sensed within", shown_figure(points.sensed_p95_mm, 3), "mm"},
      {"trials that were stopped early, which no other row has", shown_figure(points.failed, 1, 100.0), "%"}};
  return "<p>The error to expect, by the " + escape(points.controller) + ": " +
         std::to_string(points.failed.n) + " trials of " + fixed(points.trial_s, 0) +
         " s to points all over the dish, each from where the one before ended.</p>" +
         figure(table({"", "(95 % interval)", "unit"}, rows, 1),
                "As true poses would show it: less the scatter of a needle that lies still, more what the "
                "sensor reports beyond that. A calibration that is off as a whole is not in it.");
}

std::string expected_text(const std::optional<runs::PointsFigures>& points) {
  if (!points) return "error to expect at points: not measured\n";
  return "error to expect at points, by the " + points->controller + ": " +
         shown_figure(expected_mm(*points), 2) + " mm RMS; sensed " + shown_figure(points->sensed_rms_mm, 2) +
         " mm RMS, 95 % within " + shown_figure(points->sensed_p95_mm, 2) + " mm; stopped early " +
         shown_figure(points->failed, 0, 100.0) + " % of " + std::to_string(points->failed.n) + " trials\n";
}

std::string shown_gap(const runs::QualificationGap& gap) {
  return "broken off after " + fixed(gap.after_min, 1) + " minutes of it, gone on with " +
         fixed(gap.away_min, 1) + " minutes later";
}

/// What is from before a gap and what from after it, as a bench may have changed meanwhile.
std::string gap_paragraph(const runs::QualificationGap& gap) {
  std::string before;
  for (const std::string& item : gap.before) before += (before.empty() ? "" : ", ") + escape(item);
  std::string html =
      "<p>It was " + shown_gap(gap) + ". From before: " + (before.empty() ? "nothing" : before);
  if (gap.across) html += "; partly from before and partly from after: " + escape(*gap.across);
  return html +
         "; from after: all else. Changes from the beginning to the end (the step of the same pulse, the "
         "warmth of the coils, the still needle) span that gap.</p>";
}

std::string verdict_text(const QualificationResult& result) {
  std::string text;
  for (const runs::QualifiedItem& item : result.items)
    text += fmt::format("{:<42} {:>9} {:<8} {:<12} (good up to {}, acceptable up to {})\n", item.item,
                        item.value ? fixed(item.value, 2) : "-", item.unit, item.verdict, fixed(item.good, 2),
                        fixed(item.acceptable, 2));
  for (const runs::QualificationGap& gap : result.gaps) text += shown_gap(gap) + "\n";
  return text + "mend first: " + result.mend_first + "\n" + expected_text(result.points);
}

}  // namespace

std::string write_qualification_report(const std::string& folder, const std::string& out) {
  const auto result = common::read_artefact<QualificationResult>(folder + "/" + QualificationResult::kFile);
  HtmlPage page("What this bench can do", fixed(result.minutes, 1) + " minutes of it");
  std::string summary;
  if (result.stopped) summary += "<p class=\"missing\">It ended early: " + escape(*result.stopped) + "</p>";
  for (const runs::QualificationGap& gap : result.gaps) summary += gap_paragraph(gap);
  summary += "<p><b>Mend first</b>: " + escape(result.mend_first) + "</p>";
  page.add_section("verdicts", "Verdicts", summary + verdict_table(result));
  if (result.refusals)
    page.add_section(
        "refusals", "Looks without a pose",
        refusals_section(result, drawn_rig_of(common::read_json_if_there(folder + "/config.json"))));
  page.add_section("still", "A needle that lies still", still_rows(result));
  page.add_section("coils", "Coils", qualified_coils(result));
  page.add_section("motion", "What pulses do", motion_section(result));
  if (result.points) page.add_section("points", "The error to expect", points_section(*result.points));
  common::write_file_atomically(out, page.render());
  return verdict_text(result);
}

}  // namespace lodestone::report
