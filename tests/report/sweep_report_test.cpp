#include "lodestone/report/sweep_report.h"

#include <catch2/catch.hpp>

#include "lodestone/common/files.h"
#include "temporary_folder.h"

using namespace lodestone;

namespace {

runs::SweepRow row(const std::string& name, const std::vector<std::string>& settings, double mean) {
  runs::SweepRow made;
  made.point = {name, settings};
  made.scores = {mean - 0.1, mean + 0.1};
  made.mean = mean;
  made.interval = std::array<double, 2>{mean - 0.1, mean + 0.1};
  return made;
}

}  // namespace

TEST_CASE("a sweep of one number is a curve, of others bars; what is not finished says so") {
  const tests::TemporaryFolder folder;
  runs::SweepResult result{"train-policy",
                           "result.x",
                           false,
                           {row("rate=0.1", {"td3.rate=0.1"}, 0.9), row("rate=0.2", {"td3.rate=0.2"}, 0.4)}};
  result.rows[1].from_best = -0.5;
  result.rows[1].from_best_interval = std::array<double, 2>{-0.6, 0.05};
  std::string text = report::write_sweep_report(result, folder.path());
  CHECK(text.find("rate=0.1  0.9 (0.8 to 1)  –  2 of 2") != std::string::npos);
  CHECK(text.find("rate=0.2  0.4 (0.3 to 0.5)  -0.5 (-0.6 to +0.05)  2 of 2") != std::string::npos);
  CHECK(common::read_file(folder / "report.html").find("Score by value") != std::string::npos);

  result.rows.push_back(row("rate=0.1,on=</script>", {"td3.rate=0.1", "on=</script>"}, 0.3));
  result.rows.back().mean.reset();
  text = report::write_sweep_report(result, folder.path());
  CHECK(text.find("not finished") != std::string::npos);
  const std::string page = common::read_file(folder / "report.html");
  CHECK(page.find("Score by value") == std::string::npos);
  CHECK(page.find("on=</script>") == std::string::npos);  // text, not HTML
}

TEST_CASE("the rung that settings came to stands in the table") {
  const tests::TemporaryFolder folder;
  runs::SweepResult result{"deploy", "summary.x", true, {row("k=1", {"k=1"}, 0.9), row("k=2", {"k=2"}, 0.4)}};
  result.rows[0].rung = 2;
  const std::string text = report::write_sweep_report(result, folder.path());
  CHECK(text.find("rung") != std::string::npos);
  CHECK(common::read_file(folder / "report.html").find("lower is better") != std::string::npos);
}
