#include "lodestone/experiments/trial_driver.h"

#include <catch2/catch.hpp>

using namespace lodestone;

namespace {

experiments::DeploymentConfig quick_trial_config() {
  experiments::DeploymentConfig config;
  config.sensor.kind = "simulated";
  config.trials.point_seconds = 1.5;
  return config;
}

}  // namespace

TEST_CASE("virtual rigs take what the clock says in real time, and give the same as at once", "[clock]") {
  const auto config = quick_trial_config();
  const auto source = experiments::baseline_source(config);
  const auto drive = [&](bool realtime) {
    const experiments::TrialDriver driver = experiments::virtual_driver(config, 2, realtime);
    CHECK(driver.batch == (realtime ? 2 : 4));
    CHECK(driver.stopped().empty());
    const auto plan = experiments::plan_trial(config, "point", 0, std::nullopt, std::nullopt, driver.fits);
    const common::SteadyClock clock;
    const double start_s = clock.now_s();
    const auto results = driver.drive({plan}, experiments::RigKind::kExplored, source, {});
    CHECK((clock.now_s() - start_s >= config.trials.point_seconds) == realtime);
    return results.front().samples.back().true_pose->x_m;
  };
  CHECK(drive(true) == drive(false));
}

TEST_CASE("on a session trials go one after the other, and what stops it is said") {
  auto config = quick_trial_config();
  const auto source = experiments::baseline_source(config);
  const auto session = session::make_virtual_session(config.rig, config.sensor, config.safety, {});
  const experiments::TrialDriver driver = experiments::session_driver(*session, config, true);
  CHECK(driver.batch == 1);
  CHECK_FALSE(driver.fits({1.0, 0.0, 0.0}));
  const auto plan = experiments::plan_trial(config, "centre", 0, std::nullopt, std::nullopt, driver.fits);
  std::size_t seen = 0;
  const auto results = driver.drive({plan, plan}, experiments::RigKind::kReal, source,
                                    [&seen](const experiments::TrialSample&) { ++seen; });
  REQUIRE(results.size() == 2);
  CHECK(seen == results[0].samples.size() + results[1].samples.size());
  CHECK(results[1].rig == "real");
  CHECK_FALSE(results[1].truth);
  CHECK(driver.stopped().empty());
  session->coils().request_stop("somebody has had enough");
  driver.drive({plan}, experiments::RigKind::kReal, source, {});
  CHECK_THAT(driver.stopped(), Catch::Contains("enough"));
}
