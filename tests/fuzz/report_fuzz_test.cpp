#include <filesystem>

#include "fuzz.h"
#include "lodestone/common/artefact.h"
#include "lodestone/data/coverage.h"
#include "lodestone/report/report.h"
#include "report/small_run.h"
#include "temporary_folder.h"

using namespace lodestone;

namespace {

/// The files of a small run, by name.
std::vector<std::pair<std::string, common::Json>> files_of_a_run() {
  runs::DeploymentSummary summary;
  static_cast<runs::RigSummary&>(summary) = tests::deployment("explored", "policy").summary;
  data::Coverage coverage;
  coverage.transitions = 100;
  coverage.cells = 4;
  coverage.visited = 3;
  coverage.fraction = 0.75;
  coverage.evenness = 0.5;
  coverage.workspace_radius_m = 0.04;
  coverage.position_cells = 2;
  coverage.position_counts = {25, 25, 50, 0};
  coverage.heading_counts = {1, 2, 3};
  coverage.drive_counts = {4, 5};
  const common::Json trials =
      common::Json::array({common::artefact_to_json(tests::point_trial("policy", "explored")),
                           common::artefact_to_json(tests::path_trial("policy", "explored")),
                           common::artefact_to_json(tests::point_trial("baseline", "explored"))});
  return {{"deploy/summary.json", common::artefact_to_json(summary)},
          {"deploy/trials.json", trials},
          {"deploy/config.json", {{"on_rig", "explored"}, {"seed", 1}}},
          {"deploy/manifest.json", {{"git_commit", "0123456789abcdef"}, {"seed", 1}, {"host", "here"}}},
          {"collect/coverage.json", common::artefact_to_json(coverage)},
          {"collect/config.json", {{"transitions", 100}}},
          {"policy/metrics.jsonl", {{"step", 1}, {"wall_s", 0.5}, {"eval/return", -3.0}}}};
}

}  // namespace

TEST_CASE("a run with spoiled files is reported or refused by name", "[soak]") {
  const tests::Soak soak("runs with spoiled files, reported", 500, 100'000);
  const tests::TemporaryFolder folder;
  const auto good = files_of_a_run();
  for (const char* step : {"deploy", "collect", "policy"}) std::filesystem::create_directories(folder / step);
  tests::Spoiler spoiler(soak.seed(), "reports");
  const std::int64_t accepted = tests::fuzz(
      soak,
      [&] {
        const std::size_t spoiled = spoiler.below(good.size());
        for (std::size_t i = 0; i < good.size(); ++i) {
          std::string text = good[i].second.dump();
          if (i == spoiled)
            text = spoiler.below(4) == 0 ? spoiler.bytes(text, text) : spoiler.json(good[i].second).dump();
          tests::write_bytes(folder / good[i].first, text + "\n");
        }
      },
      [&] { report::report_html(report::read_run(folder.path()), std::nullopt); });
  CHECK(accepted > soak.count() / 100);
  CHECK(accepted < soak.count());
}
