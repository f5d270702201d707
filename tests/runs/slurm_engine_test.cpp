#include "lodestone/runs/slurm_engine.h"

#include <stdlib.h>

#include <catch2/catch.hpp>
#include <filesystem>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "runs/cells.h"
#include "temporary_folder.h"

using namespace lodestone;
using runs::Plan;
using tests::cell;
using tests::plan;

namespace {

/// Programs of Slurm's names that note how they are called and answer what the test put into a file.
class FakeSlurm {
 public:
  FakeSlurm() : path_before_(getenv("PATH")) {
    add("scontrol", "echo 'MaxArraySize            = 2'");
    add("squeue", "cat \"$here/queue\"");
    add("sbatch",
        "[ -e \"$here/full\" ] && { echo 'sbatch: error: too many jobs'; exit 1; }\n"
        "n=$(grep -c ^sbatch \"$here/calls\"); echo $((100 + n))");
    add("scancel", ":");
    setenv("PATH", (folder_.path() + ":" + path_before_).c_str(), 1);
    queue("");
  }
  ~FakeSlurm() { setenv("PATH", path_before_.c_str(), 1); }

  void queue(const std::string& tasks) const { common::write_file_atomically(folder_ / "queue", tasks); }
  void full() const { common::write_file_atomically(folder_ / "full", ""); }
  /// Calls since the last time.
  std::string calls() const {
    const std::string said = common::read_file(folder_ / "calls");
    std::filesystem::remove(folder_ / "calls");
    return said;
  }

 private:
  void add(const std::string& name, const std::string& body) const {
    common::write_file_atomically(folder_ / name, "#!/bin/sh\nhere=$(dirname \"$0\")\necho \"" + name +
                                                      " $*\" >> \"$here/calls\"\n" + body + "\n");
    std::filesystem::permissions(folder_ / name, std::filesystem::perms::owner_all);
  }

  tests::TemporaryFolder folder_;
  std::string path_before_;
};

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("cells become arrays that wait for each other, and a last job") {
  const FakeSlurm slurm;
  const tests::TemporaryFolder folder;
  runs::PlanPlace place{folder / "out", "lodestone", "configs"};
  Plan made = plan({cell("a"), cell("b"), cell("c"), cell("d", {"x={c}/y"}), cell("e", {"x={a}/y,{c}/y"})});
  made.minutes = 30;
  runs::SlurmEngine engine;
  engine.start(made, place, runs::wanted_cells(made));
  const std::string calls = slurm.calls();
  CHECK(has(calls, "--comment=1 --open-mode=append --output=" + place.folder +
                       "/slurm/slurm.log --array=0-1 "
                       "--cpus-per-task=1 --time=30 " +
                       place.folder + "/slurm/task.sh"));
  CHECK(has(calls, "--comment=3 --open-mode=append --output=" + place.folder +
                       "/slurm/slurm.log --dependency=aftercorr:102 --array=0 "));
  CHECK(has(calls, "--dependency=afterany:101:102 --array=0 "));
  CHECK(has(calls, "--dependency=afterany:101:102:103:104 --mem=4096M --wrap='lodestone' 'status' '" +
                       place.folder + "'"));
  CHECK(common::read_file(place.folder + "/slurm/4.job") == "104\n");
  CHECK(engine.ended());
}

TEST_CASE("what is waiting or running is not submitted again, and what needs it waits for it") {
  const FakeSlurm slurm;
  const tests::TemporaryFolder folder;
  runs::PlanPlace place{folder / "out", "lodestone", "configs"};
  place.last_command = {"bench", "paper", "--report"};
  const Plan made = plan({cell("a"), cell("b"), cell("c", {"x={b}/y"})});
  {
    runs::SlurmEngine died;
    died.start(made, place, {&made.cells[0], &made.cells[1]});
  }
  slurm.calls();
  slurm.queue("101|0|RUNNING|1\n101|1|PENDING|1\n102|N/A|PENDING|last\n");
  runs::SlurmEngine engine;
  engine.start(made, place, {&made.cells[0], &made.cells[1]});
  CHECK_FALSE(has(slurm.calls(), "sbatch"));
  CHECK_FALSE(engine.ended());
  runs::SlurmEngine more;
  more.start(made, place, runs::wanted_cells(made));
  std::string calls = slurm.calls();
  CHECK(has(calls, "--dependency=afterany:101_1 --array=0 "));
  CHECK(has(calls, "scancel 102\n"));
  CHECK(has(calls, "--dependency=afterany:101:101 "));  // the array of now has the same number, of a fake
  slurm.queue("101|0|RUNNING|1\n103|0|PENDING|2\n");    // c waits for a b that was cancelled
  runs::SlurmEngine mended;
  mended.start(made, place, runs::wanted_cells(made));
  calls = slurm.calls();
  CHECK(has(calls, "scancel 103_0\n"));
  CHECK(has(calls, "--array=0 --cpus-per-task=1 " + place.folder + "/slurm/task.sh " + place.folder +
                       "/slurm/4.tasks"));
  slurm.queue("101|0|COMPLETING|1\n");  // stopped, and about to end: it runs again after that
  runs::SlurmEngine again;
  again.start(made, place, {&made.cells[0]});
  CHECK(has(slurm.calls(), "--dependency=afterany:101_0 --array=0 "));
  again.stop();
  CHECK(has(slurm.calls(), "scancel --name=lodestone-"));
}

TEST_CASE("a cluster that takes no job says why") {
  const FakeSlurm slurm;
  slurm.full();
  const tests::TemporaryFolder folder;
  const Plan made = plan({cell("a")});
  runs::SlurmEngine engine;
  CHECK_THROWS_WITH(engine.start(made, {folder / "out", "lodestone", "configs"}, runs::wanted_cells(made)),
                    Catch::Contains("too many jobs"));
}
