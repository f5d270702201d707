#include "lodestone/report/qualification_report.h"

#include <catch2/catch.hpp>

#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/runs/qualification_result.h"
#include "report/small_run.h"
#include "temporary_folder.h"

using namespace lodestone;

namespace {

runs::QualificationResult small_qualification() {
  runs::QualificationResult result;
  result.dish_radius_mm = 42.5;
  result.minutes = 12.34;
  result.refusals.emplace().share = {0.125, 8, std::array<double, 2>{0.02, 0.47}};
  result.refusals->cell_mm = 8.5;
  result.refusals->heading_bin_deg = 30.0;
  result.refusals->cells = {{4.25, 4.25, 0.0, 4, 1}, {12.75, 4.25, 0.0, 4, 0}};
  result.refusals->headings = {{0.0, 0.0, -180.0, 8, 1}};
  result.refusals->reasons = {{"no <needle>", 1}};
  runs::CoilFigures& coil = result.coils.emplace_back();
  coil.name = "+x";
  coil.gain = runs::Measured{0.5, 5, std::array<double, 2>{0.49, 0.51}};
  coil.why = "gain by motion: not measured";
  runs::StickSlipFigures& stick_slip = result.stick_slip.emplace();
  stick_slip.places = {{1.0, 2.0, 0.75, 2.0, 60}, {3.0, 4.0, {}, 15.0, 60}};
  stick_slip.levels = {{0.5, 60, 40, 0.2, 0.15}, {0.7, 60, 60, 0.4, 0.2}};
  result.items = {
      {"gain of a coil, off 1 by", 50.0, "%", 5.0, 10.0, "mend", "a reason", "rig check"},
      {"latency from command to motion", {}, "ms", 50.0, 200.0, "not measured", "a rest", "rest"}};
  result.mend_first = "gain of a coil, off 1 by: rig check";
  return result;
}

}  // namespace

TEST_CASE("a qualification comes with verdicts, what to mend first and a map") {
  const tests::TemporaryFolder folder;
  CHECK_THROWS_AS(report::write_qualification_report(folder.path(), folder / "report.html"), common::Error);
  common::write_artefact(folder / runs::QualificationResult::kFile, small_qualification());
  const std::string text = report::write_qualification_report(folder.path(), folder / "report.html");
  CHECK(tests::holds(text, "gain of a coil, off 1 by"));
  CHECK(tests::holds(text, "not measured"));
  CHECK(tests::holds(text, "mend first: gain of a coil, off 1 by: rig check\n"));
  CHECK(tests::holds(text, "error to expect at points: not measured\n"));

  const std::string page = common::read_file(folder / "report.html");
  CHECK(tests::holds(page, "What this bench can do"));
  CHECK(tests::holds(page, "12.3 minutes of it"));
  CHECK(tests::holds(page, "Share of looks without a pose over the dish"));
  CHECK(tests::holds(page, "data-value=\"25\""));
  CHECK(tests::holds(page, "no &lt;needle&gt;"));
  CHECK(tests::holds(page, "0.500 (0.490 to 0.510)"));
  CHECK(tests::holds(page, "more than 15.00"));
  CHECK(tests::holds(page, "id=\"steps\""));
  CHECK_FALSE(tests::holds(page, "It ended early"));
  CHECK_FALSE(tests::holds(page, "broken off"));
  CHECK_FALSE(tests::holds(page, "id=\"points\""));
  CHECK(tests::holds(page, ">+y<"));
  // The coils that are drawn are those of the run's own rig.
  common::write_file_atomically(folder / "config.json",
                                R"({"rig": {"dish": {"radius_m": 0.02}, "coils": {"each": [
    {"name": "at60", "position_m": [0.039, 0.06755, 0.0]}, {"name": "under", "position_m": [0.0, 0.0, -0.1]}]}}})");
  report::write_qualification_report(folder.path(), folder / "report.html");
  const std::string other = common::read_file(folder / "report.html");
  CHECK(tests::holds(other, ">at60<"));
  CHECK_FALSE(tests::holds(other, ">under<"));
  CHECK_FALSE(tests::holds(other, ">+y<"));
}

TEST_CASE("a page says what was measured before a gap, and what after it") {
  const tests::TemporaryFolder folder;
  runs::QualificationResult result = small_qualification();
  result.gaps = {{5.24, 41.0, {"still needle", "coils"}, "same <pulse>"}, {9.0, 0.5, {}, {}}};
  common::write_artefact(folder / runs::QualificationResult::kFile, result);
  const std::string text = report::write_qualification_report(folder.path(), folder / "report.html");
  CHECK(tests::holds(text, "broken off after 5.2 minutes of it, gone on with 41.0 minutes later\n"));
  CHECK(tests::holds(text, "broken off after 9.0 minutes of it, gone on with 0.5 minutes later\n"));
  const std::string page = common::read_file(folder / "report.html");
  CHECK(tests::holds(page, "It was broken off after 5.2 minutes of it"));
  CHECK(tests::holds(page,
                     "From before: still needle, coils; partly from before and partly from after: "
                     "same &lt;pulse&gt;; from after: all else."));
  CHECK(tests::holds(page, "From before: nothing; from after: all else."));
}

TEST_CASE("a qualification that was stopped at once has a page, too") {
  const tests::TemporaryFolder folder;
  runs::QualificationResult result;
  result.stopped = "a key was pressed";
  result.mend_first = "nothing";
  common::write_artefact(folder / runs::QualificationResult::kFile, result);
  report::write_qualification_report(folder.path(), folder / "report.html");
  const std::string page = common::read_file(folder / "report.html");
  CHECK(tests::holds(page, "It ended early: a key was pressed"));
  CHECK_FALSE(tests::holds(page, "id=\"refusals\""));
}

TEST_CASE("a qualification ends with the error to expect") {
  const tests::TemporaryFolder folder;
  runs::QualificationResult result = small_qualification();
  runs::PointsFigures& points = result.points.emplace();
  points.controller = "planner";
  points.trial_s = 20.0;
  points.failed = {0.25, 16, std::array<double, 2>{0.1, 0.5}};
  points.sensed_rms_mm = runs::Measured{0.25, 12, std::array<double, 2>{0.2, 0.3}};
  points.sensed_p95_mm = runs::Measured{0.4, 12, std::array<double, 2>{0.3, 0.5}};
  points.rms_mm = runs::Measured{0.27, 12, std::array<double, 2>{0.22, 0.32}};
  const auto ends_with = [](const std::string& text, const std::string& end) {
    return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
  };
  const auto written = [&] {
    common::write_artefact(folder / runs::QualificationResult::kFile, result);
    return report::write_qualification_report(folder.path(), folder / "report.html");
  };
  CHECK(
      ends_with(written(),
                "error to expect at points, by the planner: 0.27 (0.22 to 0.32) mm RMS; sensed 0.25 (0.20 to "
                "0.30) mm RMS, 95 % within 0.40 (0.30 to 0.50) mm; stopped early 25 (10 to 50) % of 16 "
                "trials\n"));
  const std::string page = common::read_file(folder / "report.html");
  CHECK(tests::holds(page, "id=\"points\""));
  CHECK(tests::holds(page, "16 trials of 20 s"));
  CHECK(tests::holds(page, "0.270 (0.220 to 0.320)"));
  result.points->rms_mm.reset();
  CHECK(tests::holds(written(), "by the planner: 0.25 (0.20 to 0.30) mm RMS"));
}
