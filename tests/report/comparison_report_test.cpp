#include "lodestone/report/comparison_report.h"

#include <catch2/catch.hpp>

#include "lodestone/common/files.h"
#include "runs/trial_records.h"
#include "temporary_folder.h"

using namespace lodestone;

TEST_CASE("a comparison is said, tabulated and drawn; names are text, not HTML") {
  runs::ComparedRun first{"A", "A", "policy", 0, {{"seed", 1}}, {}},
      other{"<b>&B", "B", "planner", 0, {{"seed", 2}}, {}};
  for (std::int64_t trial = 0; trial < 8; ++trial) {
    first.trials.push_back(tests::point_trial(trial, 1.0 + 0.1 * static_cast<double>(trial)));
    other.trials.push_back(tests::point_trial(trial, 0.8 + 0.1 * static_cast<double>(trial)));
  }
  other.trials.push_back(tests::point_trial(8, 1.0));
  const tests::TemporaryFolder folder;
  const std::string text =
      report::write_comparison_report(runs::compare_runs({first, other}), folder / "report.html");
  CHECK(text.find("the error of <b>&B is 0.20 mm smaller than that of A") != std::string::npos);
  CHECK(text.find("Not like with like: the runs differ in seed") != std::string::npos);
  CHECK(text.find("error (mm): 1.35 -> 1.15, difference -0.20 (-0.20 to -0.20)") != std::string::npos);
  CHECK(text.find("left out: point, unseen: 1 trials of A and <b>&B.") != std::string::npos);
  const std::string page = common::read_file(folder / "report.html");
  CHECK(page.find("<td><b>&B") == std::string::npos);
  CHECK(page.find("<td>&lt;b&gt;&amp;B</td>") != std::string::npos);
  CHECK(page.find("is 0.20 mm smaller") != std::string::npos);
  CHECK(page.find("point-unseen-1") != std::string::npos);
  CHECK(page.find("<code>seed</code>") != std::string::npos);
}
