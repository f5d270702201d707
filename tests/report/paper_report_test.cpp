#include "lodestone/report/paper_report.h"

#include <catch2/catch.hpp>
#include <filesystem>

#include "lodestone/common/files.h"
#include "report/kept_paper.h"
#include "temporary_folder.h"

using namespace lodestone;
using tests::Kept;

TEST_CASE("the page shows what is there beside the paper's, and what is missing as missing") {
  const tests::TemporaryFolder folder;
  Kept made;
  made.add_trials("transfer/paper/bare/centre/1", 11, {6.0, 8.0});
  made.add("transfer/best/bare/point/1", false);
  made.add_training("policy/paper/centre/1", tests::kRising);
  made.add_training("mix/3/1", tests::kRisen);
  made.add_trials("ablation/without_memory/point/1", 1, {4.0, 5.0});
  made.add_trials("ablation/without_memory/square/1", 2, {4.0, 5.0});
  const std::string text = report::write_paper_report(made.kept, {}, folder.path());
  const std::string page = common::read_file(folder / "report.html");
  for (const char* part : {"6.3 ± 2.1", "7.00 ± 1.41", "1.5 h", "had not converged", "without memory",
                           "our TD3, in our MBS", "not run yet", "fewer than 200 trials", "Scale quick"}) {
    CAPTURE(part);
    CHECK(text.find(part) != std::string::npos);
    CHECK(page.find(part) != std::string::npos);
  }
  CHECK(common::read_file(folder / "images/paper_bare_centre.svg").find("Trajectories: centre") !=
        std::string::npos);
  CHECK(common::Json::parse(common::read_file(folder / "report.json"))["mixes"]["3"]["final_return"] == 10.0);
}

TEST_CASE("seeds of one row that were run with two presets are named, and every processor once") {
  const tests::TemporaryFolder folder;
  Kept made;
  made.add_training("policy/best/centre/1", tests::kRisen);
  made.add_training("policy/best/centre/2", tests::kRisen);
  made.add_training("policy/best/target/1", tests::kRisen);
  made.kept.records["policy/best/centre/2"].preset = {{"td3", {{"discount", 0.9}}}};
  made.kept.records["policy/best/target/1"].machine["continued"] = {
      {{"processor", "Faster"}, {"processors", 64}, {"git_commit", "def"}}, {{"processors", "x"}}, 5};
  const std::string text = report::write_paper_report(made.kept, {}, folder.path());
  CHECK(text.find("were run with presets that differ: policy/best/centre.") != std::string::npos);
  CHECK(text.find("Fast, 2 processors, Faster, 64 processors") != std::string::npos);
}

TEST_CASE("nothing gives a page that says so") {
  const tests::TemporaryFolder folder;
  CHECK(report::write_paper_report(Kept().kept, {}, folder.path()).find("0 of 0 cells") != std::string::npos);
  CHECK(std::filesystem::exists(folder / "report.html"));
}
