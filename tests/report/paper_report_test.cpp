#include "lodestone/report/paper_report.h"

#include <catch2/catch.hpp>
#include <filesystem>

#include "lodestone/common/artefact.h"
#include "lodestone/common/files.h"
#include "lodestone/runs/deployment_results.h"
#include "lodestone/runs/run_folder.h"
#include "report/small_run.h"
#include "temporary_folder.h"

namespace {

using lodestone::common::artefact_to_json;
using lodestone::common::Json;
using lodestone::tests::write_with_folders;
namespace runs = lodestone::runs;

void write_state(const std::string& cell, bool finished) {
  runs::RunState state;
  state.finished = finished;
  write_with_folders(cell + "/run.json", artefact_to_json(state).dump());
}

/// Two trials that ended so far from the target; success below 3 mm.
void write_transfer(const std::string& cell, double one_mm, double other_mm) {
  Json trials = Json::array();
  for (const double error_mm : {one_mm, other_mm}) {
    runs::TrialRecord record;
    record.task = "centre";
    record.controller = "planner";
    record.target_mm = {0.0, 0.0};
    record.trajectory = {{20.0, 10.0, 0.1}, {0.5, 0.1, 0.3}};
    record.completed = true;
    record.truth.emplace().final_error_mm = error_mm;
    record.truth->success = error_mm < 3.0;
    trials.push_back(artefact_to_json(record));
  }
  write_with_folders(cell + "/trials.json", trials.dump());
  write_state(cell, true);
}

void write_training(const std::string& cell, double seconds, double last_return) {
  runs::PolicyResult result;
  result.seconds_to_95_percent = seconds;
  result.train_seconds = 2.0 * seconds;
  write_with_folders(cell + "/result.json", artefact_to_json(result).dump());
  write_with_folders(cell + "/metrics.jsonl",
                     "{\"step\":0,\"evaluation/episode_return\":-1.0,\"evaluation/success_rate\":0.0}\n"
                     "{\"step\":100,\"evaluation/episode_return\":" +
                         std::to_string(last_return) + ",\"evaluation/success_rate\":0.5}\n");
  write_state(cell, true);
}

}  // namespace

TEST_CASE("errors are pooled over the training seeds that are done, with intervals, beside the paper's") {
  const lodestone::tests::TemporaryFolder folder;
  write_transfer(folder / "cells/transfer/best/centre/1", 1.0, 2.0);
  write_transfer(folder / "cells/transfer/best/centre/2", 3.5, 1.5);
  write_transfer(folder / "cells/transfer/best/centre/3", 50.0, 50.0);
  write_state(folder / "cells/transfer/best/centre/3", false);  // still running
  write_transfer(folder / "cells/transfer/paper/centre/1", 6.0, 8.0);
  write_training(folder / "cells/policy/best/centre/1", 10.0, 4.0);
  write_training(folder / "cells/policy/best/centre/2", 14.0, 6.0);
  write_training(folder / "cells/policy/paper/centre/1", 30.0, 4.0);
  write_training(folder / "cells/mix/3/1", 5.0, 2.5);
  write_transfer(folder / "cells/ablation/without_memory/point/1", 4.0, 5.0);
  write_transfer(folder / "cells/ablation/without_memory/square/1", 4.0, 5.0);
  const std::string text = lodestone::report::write_paper_report(folder.path(), "quick");

  const Json json = Json::parse(lodestone::common::read_file(folder / "report.json"));
  const Json& best = json["transfer"]["best"]["centre"];
  CHECK(best["n_trials"] == 4);
  CHECK(best["n_seeds"] == 2);
  CHECK(best["mean_error_mm"].get<double>() == Approx(2.0));
  CHECK(best["iqm_error_mm"].get<double>() == Approx(1.75));
  CHECK(best["success_rate"].get<double>() == Approx(0.75));
  CHECK(best["success_interval"][0].get<double>() == Approx(0.3006).margin(1e-3));  // Wilson, 3 of 4
  CHECK(best["iqm_interval_mm"][0].get<double>() < 1.75);
  CHECK(best["iqm_interval_mm"][1].get<double>() > 1.75);
  CHECK(json["training"]["best"]["centre"]["seconds_to_95_percent"].get<double>() == Approx(12.0));
  CHECK(json["mixes"]["3"]["final_return"].get<double>() == Approx(2.5));
  CHECK(json["ablations"]["without memory"]["point"]["mean_error_mm"].get<double>() == Approx(4.5));
  // Drawn as what drove, which the trials say.
  CHECK(lodestone::common::read_file(folder / "images/best_centre.svg").find("centre, planner") !=
        std::string::npos);
  for (const char* part : {"6.3 ± 2.1", "7.00 ± 1.41", "1.5 h", "without memory"}) {
    CAPTURE(part);
    CHECK(text.find(part) != std::string::npos);
    CHECK(lodestone::common::read_file(folder / "report.html").find(part) != std::string::npos);
  }
}

TEST_CASE("an empty folder gives an empty report") {
  const lodestone::tests::TemporaryFolder folder;
  CHECK(lodestone::report::write_paper_report(folder.path(), "smoke").empty());
  CHECK(std::filesystem::exists(folder / "report.html"));
}
