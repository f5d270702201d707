#include "lodestone/report/run_data.h"

#include <catch2/catch.hpp>
#include <filesystem>

#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "report/small_run.h"
#include "temporary_folder.h"

using namespace lodestone::report;
using lodestone::common::write_file_atomically;

TEST_CASE("the folder of a deployment is a run that holds nothing else") {
  const lodestone::tests::TemporaryFolder folder;
  lodestone::runs::DeploymentSummary summary;
  static_cast<lodestone::runs::RigSummary&>(summary) =
      lodestone::tests::deployment("explored", "planner").summary;
  lodestone::common::write_artefact(folder / "summary.json", summary);
  write_file_atomically(folder / "trajectories.csv", "rig\n");
  CHECK_FALSE(read_run(folder.path()).reach);
  lodestone::runs::ReachMap map;
  map.cell_mm = 4.0;
  lodestone::common::write_artefact(folder / "reachable.json", map);
  const RunData run = read_run(folder.path());
  CHECK(run.reach->cell_mm == 4.0);
  CHECK(run.deployment_only);
  REQUIRE(run.rigs.size() == 1);
  CHECK(run.rigs.front().driver() == "planner");
  CHECK(run.rigs.front().success_radius_mm == 3.0);
  write_file_atomically(folder / "config.json", R"({"score": {"success_radius_m": 0.0015}})");
  CHECK(read_run(folder.path()).rigs.front().success_radius_mm == Approx(1.5));
  write_file_atomically(folder / "config.json", R"({"score": 3})");
  CHECK(read_run(folder.path()).rigs.front().success_radius_mm == 3.0);
}

TEST_CASE("a curve leaves out lines without it, and a last line that was cut off is dropped") {
  const lodestone::tests::TemporaryFolder folder;
  write_file_atomically(folder / "m.jsonl",
                        "{\"step\":1,\"a\":2.5}\n{\"step\":2}\n{\"step\":3,\"a\":1.5}\n{\"st");
  CHECK(curve(read_lines(folder / "m.jsonl"), "a") == Curve{{1.0, 2.5}, {3.0, 1.5}});
  write_file_atomically(folder / "bad.jsonl", "{\"st\n{\"step\":2}\n");
  CHECK_THROWS_AS(read_lines(folder / "bad.jsonl"), lodestone::common::DataError);
  CHECK(read_lines(folder / "none.jsonl").empty());
}
