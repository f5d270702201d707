#include "lodestone/experiments/qualification.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <string>

#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/common/statistics.h"
#include "temporary_folder.h"

using namespace lodestone;

namespace {

experiments::QualificationConfig short_qualification(double minutes) {
  experiments::QualificationConfig config;
  config.sensor.kind = "simulated";
  config.rig.simulation.deviation = rig::DeviationWidth::kNone;
  config.minutes = minutes;
  config.points.count = 0;
  return config;
}

experiments::QualificationConfig with_points(double minutes, std::int64_t count, double seconds) {
  experiments::QualificationConfig config = short_qualification(minutes);
  config.points.count = count;
  config.points.seconds = seconds;
  return config;
}

/// Goes on until an item is next, or to the end. Returns how many steps there were of each.
std::map<std::string, int> go_on(experiments::Qualification& work, const std::string& until = "") {
  common::MetricsLog metrics("");  // nothing is written
  std::map<std::string, int> steps;
  for (runs::Progress now = work.progress(); !now.finished && now.note != until; now = work.progress()) {
    ++steps[now.note];
    work.step(metrics);
  }
  return steps;
}

runs::QualificationResult qualified(const experiments::QualificationConfig& config) {
  const auto bench = experiments::make_qualification_session(config);
  experiments::Qualification work(config, *bench, experiments::points_source(config));
  go_on(work);
  return work.result();
}

common::Json state_in(const std::string& folder) {
  return common::read_json_if_there(folder + experiments::QualificationState::kFile);
}

const runs::QualifiedItem& item_of(const runs::QualificationResult& result, const std::string& name) {
  const auto found = std::find_if(result.items.begin(), result.items.end(),
                                  [&](const runs::QualifiedItem& item) { return item.item == name; });
  REQUIRE(found != result.items.end());
  return *found;
}

/// Coils of which one gives half of what it is asked for, and which may report no currents.
class HalvedCoil final : public rig::Coils {
 public:
  HalvedCoil(rig::Coils& inner, bool reports) : inner_(inner), reports_(reports) {}
  void apply(const rig::CoilPulse& pulse) override {
    rig::CoilPulse given = pulse;
    if (given.current_A.size() > kHalved) given.current_A[kHalved] *= 0.5;
    inner_.apply(given);
  }
  void stop() noexcept override { inner_.stop(); }
  rig::CoilStatus status() override {
    rig::CoilStatus status = inner_.status();
    if (!reports_) status.current_A = physics::PerCoil();
    return status;
  }

  static constexpr std::size_t kHalved = 2;

 private:
  rig::Coils& inner_;
  bool reports_;
};

/// A sensor that something can come before.
class CoveredSensor final : public control::PoseSensor {
 public:
  explicit CoveredSensor(control::PoseSensor& inner) : inner_(inner) {}
  control::PoseEstimate observe() override {
    if (covered_ == 0) return inner_.observe();
    --covered_;
    control::PoseEstimate none;
    none.reason = "a hand";
    none.blind = true;
    return none;
  }
  void acquire() override { inner_.acquire(); }
  void pulsed(const physics::PerCoil& current_A,
              const std::vector<physics::PulseOutcome>& outcomes) override {
    inner_.pulsed(current_A, outcomes);
  }
  void pulse_cut() override { inner_.pulse_cut(); }
  void expect_nothing() override { inner_.expect_nothing(); }
  void forget() override { inner_.forget(); }
  /// For the next so many observations.
  void cover(int observations) { covered_ = observations; }

 private:
  control::PoseSensor& inner_;
  int covered_ = 0;
};

/// A bench that nobody can put back to where it was, as a real one, with such coils and such a sensor.
class BenchWithHalfACoil {
 public:
  explicit BenchWithHalfACoil(const experiments::QualificationConfig& config, bool reports = true)
      : rig_(config.rig, 1),
        halved_(rig_.coils(), reports),
        sensing_(config.sensor, config.rig),
        sensor_(sensing_.make(rig_, sensing_.calibrated_bench(1), common::RandomStream(1, "sensor noise"))),
        covered_(*sensor_),
        coils_(halved_, config.safety, config.rig, rig_.clock()) {}
  session::RigSession open() {
    session::RigSession::Parts parts;
    parts.coils = &coils_;
    parts.sensor = &covered_;
    parts.clock = &rig_.clock();
    parts.fits = [this](const geometry::Pose2& pose) { return rig_.fits(pose); };
    return session::RigSession(parts);
  }
  CoveredSensor& sensor() { return covered_; }

 private:
  rig::VirtualRig rig_;
  HalvedCoil halved_;
  session::Sensing sensing_;
  std::unique_ptr<session::RigSensor> sensor_;
  CoveredSensor covered_;
  safety::Supervisor coils_;
};

runs::QualificationResult qualified_with_half_a_coil(const experiments::QualificationConfig& config,
                                                     bool reports) {
  BenchWithHalfACoil bench(config, reports);
  session::RigSession opened = bench.open();
  experiments::Qualification work(config, opened, experiments::points_source(config));
  go_on(work);
  return work.result();
}

}  // namespace

TEST_CASE("a bench with zones to keep out of is not qualified") {
  experiments::QualificationConfig config;
  CHECK_NOTHROW(config.validate());
  config.safety.keep_out = {{"vessel", {0.0, 0.0}, 0.004}};
  CHECK_THROWS_WITH(config.validate(), Catch::Contains("safety.keep_out"));
}

TEST_CASE("a virtual bench is qualified item by item within its time, each time the same") {
  const experiments::QualificationConfig config = short_qualification(2.0);
  const auto bench = experiments::make_qualification_session(config);
  experiments::Qualification work(config, *bench, experiments::points_source(config));
  CHECK(work.progress().total == 120);
  const std::map<std::string, int> steps = go_on(work);
  CHECK(work.progress().done == 120);
  const runs::QualificationResult result = work.result();
  CHECK_FALSE(result.stopped);
  CHECK(result.gaps.empty());
  CHECK(result.minutes <= 2.5);
  CHECK(steps.size() == 9);
  CHECK(steps.at("still needle") == 1);
  CHECK(steps.at("coils") > 4);
  REQUIRE(result.still);
  CHECK(result.still->x_mm.n > 50);
  CHECK(result.still->x_mm.value == Approx(0.015).margin(0.006));  // sensor.simulated.repeatability_m
  CHECK(result.still->whitened_position->value < 1.0);
  REQUIRE(result.refusals);
  CHECK(result.refusals->share.n > 100);
  REQUIRE(result.latency);
  CHECK(result.latency->ms.value < 60.0);
  CHECK(result.latency->resolution_ms == Approx(1e3 * config.needle.look_s));
  REQUIRE(result.same_pulse);
  CHECK(result.same_pulse->step_mm.value > 0.3);
  REQUIRE(result.coils.size() == 4);
  for (const runs::CoilFigures& coil : result.coils) {
    REQUIRE(coil.gain);
    CHECK(coil.gain->value == Approx(1.0).margin(0.04));
    CHECK(coil.rise_ms->value == Approx(20.4).margin(3.0));  // ln 9 L / R
    CHECK(coil.skew_ms->value == Approx(0.0).margin(1.0));
    CHECK(*coil.last_C >= *coil.first_C);
  }
  REQUIRE(result.stick_slip);
  CHECK(result.stick_slip->current_A);
  CHECK(result.stick_slip->levels.size() >= 3);
  CHECK_FALSE(result.points);
  CHECK(result.items.size() == 15);
  CHECK(result.items.back().verdict == "not measured");
  CHECK_FALSE(result.mend_first.empty());
  CHECK(common::artefact_to_json(qualified(config)) == common::artefact_to_json(result));
}

TEST_CASE("friction that scatters more is seen to scatter more") {
  experiments::QualificationConfig config = short_qualification(3.0);
  config.rig.friction.map_sigma = 0.05;
  config.rig.friction.pulse_sigma = 0.02;
  const runs::QualificationResult smooth = qualified(config);
  config.rig.friction.pulse_sigma = 0.6;
  const runs::QualificationResult rough = qualified(config);
  REQUIRE(smooth.same_pulse);
  REQUIRE(rough.same_pulse);
  CHECK(rough.same_pulse->share_of_step.value > 1.3 * smooth.same_pulse->share_of_step.value);
}

TEST_CASE("a worse sensor is seen to be worse") {
  experiments::QualificationConfig config = short_qualification(2.0);
  const runs::QualificationResult good = qualified(config);
  config.sensor.simulated.repeatability_m *= 10.0;
  config.sensor.simulated.position_rms_m *= 5.0;
  config.sensor.simulated.dropout = 0.5;
  const runs::QualificationResult bad = qualified(config);
  REQUIRE(bad.still);
  CHECK(bad.still->x_mm.value > 5.0 * good.still->x_mm.value);
  CHECK(bad.still->refused > 3);
  CHECK(bad.refusals->share.value > 2.0 * good.refusals->share.value);
  CHECK(good.refusals->share.value < 0.15);
  CHECK(item_of(bad, "repeatability of position").verdict != "good");
  CHECK(item_of(good, "repeatability of position").verdict == "good");
}

TEST_CASE("a coil of half its gain is told") {
  const runs::QualificationResult result =
      qualified_with_half_a_coil(short_qualification(1.5), /*reports=*/true);
  CHECK_FALSE(result.stopped);
  REQUIRE(result.coils.size() == 4);
  for (std::size_t coil = 0; coil < 4; ++coil) {
    REQUIRE(result.coils[coil].gain);
    CHECK(result.coils[coil].gain->value == Approx(coil == HalvedCoil::kHalved ? 0.5 : 1.0).margin(0.04));
  }
  CHECK(item_of(result, "gain of a coil, off 1 by").verdict == "mend");
}

TEST_CASE("where coils report no currents that is said") {
  const runs::QualificationResult result =
      qualified_with_half_a_coil(short_qualification(0.5), /*reports=*/false);
  for (const runs::CoilFigures& coil : result.coils) {
    CHECK_FALSE(coil.gain);
    CHECK(coil.why.find("the coils report none") != std::string::npos);
  }
  CHECK(item_of(result, "gain of a coil, off 1 by").verdict == "not measured");
}

TEST_CASE("what was measured until a stop is kept, and the coils are off") {
  const experiments::QualificationConfig config = short_qualification(2.0);
  const auto bench = experiments::make_qualification_session(config);
  experiments::Qualification work(config, *bench, experiments::points_source(config));
  go_on(work, "latency");
  bench->coils().request_stop("somebody said so");
  CHECK(go_on(work).at("latency") == 1);
  CHECK(work.progress().note == "stopped");
  const runs::QualificationResult result = work.result();
  REQUIRE(result.stopped);
  CHECK(result.stopped->find("somebody said so") != std::string::npos);
  CHECK(bench->coils().latched());
  CHECK(result.still);
  CHECK(result.coils.front().gain);
  CHECK_FALSE(result.latency);
  const rig::CoilStatus status = bench->coils().status();
  for (const double current_A : status.current_A) CHECK(std::abs(current_A) < 0.1);
}

TEST_CASE("a virtual bench goes on after any step as if never stopped, from where its item began") {
  const experiments::QualificationConfig config = with_points(0.5, 8, 1.0);
  const runs::QualificationResult undisturbed = qualified(config);
  REQUIRE(undisturbed.points);
  CHECK(undisturbed.points->failed.n >= 1);
  const common::Json whole = common::artefact_to_json(undisturbed);
  const tests::TemporaryFolder folder;
  for (const char* item : {"still needle", "coils", "weak pulses", "still needle again", "points", ""}) {
    CAPTURE(item);
    const std::string path = folder / (std::string("before ") + item);
    common::make_folders(path);
    {
      const auto bench = experiments::make_qualification_session(config);
      experiments::Qualification work(config, *bench, experiments::points_source(config));
      common::MetricsLog metrics(path);
      go_on(work, item);
      if (*item != '\0') work.step(metrics);  // it is killed in the middle of it
      work.save(path);
    }
    const auto bench = experiments::make_qualification_session(config);
    experiments::Qualification work(config, *bench, experiments::points_source(config));
    work.load(path);
    const std::map<std::string, int> steps = go_on(work);
    CHECK(steps.count("still needle") == 0);  // it had ended, in one step
    CHECK(common::artefact_to_json(work.result()) == whole);
  }
}

TEST_CASE("a bench that was measured in part is measured on, piece by piece, and says where the gap is") {
  const experiments::QualificationConfig config = short_qualification(2.0);
  const tests::TemporaryFolder folder;
  BenchWithHalfACoil bench(config);
  runs::QualificationResult before;
  std::size_t rises = 0;
  {
    session::RigSession opened = bench.open();
    experiments::Qualification work(config, opened, experiments::points_source(config));
    common::MetricsLog metrics(folder.path());
    go_on(work, "coils");
    for (int piece = 0; piece < 3; ++piece) {
      work.step(metrics);
      work.save(folder.path());
    }
    work.step(metrics);  // killed before this is on the disk
    before = work.result();
    const common::Json state = state_in(folder.path());
    for (const common::Json& coil : state.at("rises")) rises += coil.size();
  }
  CHECK(rises == 3);
  session::RigSession opened = bench.open();
  experiments::Qualification work(config, opened, experiments::points_source(config));
  work.load(folder.path());
  CHECK(work.progress().note == "coils");
  const runs::QualificationResult loaded = work.result();
  REQUIRE(loaded.still);
  REQUIRE(before.still);
  CHECK(loaded.minutes < before.minutes);
  CHECK(loaded.minutes == Approx(state_in(folder.path()).at("passed_s").get<double>() / 60.0));
  CHECK(loaded.still->x_mm.value == before.still->x_mm.value);
  const std::map<std::string, int> steps = go_on(work);
  CHECK(steps.count("still needle") == 0);
  const runs::QualificationResult result = work.result();
  CHECK_FALSE(result.stopped);
  CHECK(result.minutes <= 2.5);
  REQUIRE(result.gaps.size() == 1);
  CHECK(result.gaps[0].after_min == Approx(loaded.minutes));
  CHECK(result.gaps[0].away_min >= 0.0);
  CHECK(result.gaps[0].away_min < 1.0);
  CHECK(result.gaps[0].before == std::vector<std::string>{"still needle"});
  CHECK(result.gaps[0].across.value_or("") == "coils");
  CHECK(result.refusals->share.n > loaded.refusals->share.n);
  CHECK(result.latency);
  for (const runs::CoilFigures& coil : result.coils) CHECK(coil.gain);
  work.save(folder.path());

  // What has ended goes on nowhere: there is no gap behind it.
  experiments::Qualification again(config, opened, experiments::points_source(config));
  again.load(folder.path());
  CHECK(again.progress().finished);
  CHECK(again.result().gaps.size() == 1);
  CHECK(again.result().minutes == Approx(result.minutes));
}

TEST_CASE("what a step left half-done when it was stopped does not count") {
  const experiments::QualificationConfig config = short_qualification(1.0);
  const tests::TemporaryFolder folder;
  BenchWithHalfACoil bench(config);
  session::RigSession opened = bench.open();
  experiments::Qualification work(config, opened, experiments::points_source(config));
  work.save(folder.path());
  CHECK(state_in(folder.path()).is_null());  // nothing was measured yet
  go_on(work, "latency");
  work.save(folder.path());
  const common::Json saved = state_in(folder.path());
  opened.coils().request_stop("somebody said so");
  go_on(work);
  REQUIRE(work.result().stopped);
  work.save(folder.path());
  CHECK(state_in(folder.path()) == saved);
}

TEST_CASE("a state that is of another bench is refused, and none is none") {
  const experiments::QualificationConfig config = short_qualification(1.0);
  const tests::TemporaryFolder folder;
  const auto bench = experiments::make_qualification_session(config);
  experiments::Qualification work(config, *bench, experiments::points_source(config));
  work.load(folder.path());
  CHECK(work.progress().note == "still needle");
  go_on(work, "coils");
  work.save(folder.path());
  const common::Json whole = state_in(folder.path());
  const auto refused = [&](const char* key, const common::Json& value) {
    common::Json state = whole;
    state[key] = value;
    common::write_json(folder.path() + experiments::QualificationState::kFile, state);
    const auto other = experiments::make_qualification_session(config);
    CHECK_THROWS_AS(
        experiments::Qualification(config, *other, experiments::points_source(config)).load(folder.path()),
        common::DataError);
  };
  refused("rises", common::Json::array());
  refused("item", 10);
  refused("points_mm", nullptr);
  refused("points_mm", common::Json::array({0.4, nullptr}));
  refused("points_mm", common::Json::array({-0.4}));
  refused("pieces", -1);
  refused("bench", nullptr);
  refused("weak", "many");
}

TEST_CASE("the error to expect is what a short deployment on the bench itself comes to") {
  const experiments::QualificationConfig config = with_points(1.5, 5, 6.0);
  const auto bench = experiments::make_qualification_session(config);
  experiments::Qualification work(config, *bench, experiments::points_source(config));
  go_on(work, "points");
  CHECK_FALSE(work.result().points);
  const experiments::DeploymentConfig deployment = config.deploy().deployment;
  const auto fits = [&bench](const geometry::Pose2& pose) { return bench->fits(pose); };
  common::MetricsLog metrics("");  // nothing is written
  std::vector<double> true_mm;
  while (!work.progress().finished) {
    const auto trial = static_cast<std::int64_t>(true_mm.size());
    work.step(metrics);
    const std::optional<runs::PointsFigures> points = work.result().points;
    if (!points || points->failed.n == trial) continue;
    const geometry::Vector2 target_m =
        experiments::plan_trial(deployment, "point", trial, std::nullopt, std::nullopt, fits).target_m;
    true_mm.push_back(geometry::kMmPerM * (bench->truth()->true_pose().position_m() - target_m).norm());
  }
  const runs::QualificationResult result = work.result();
  CHECK_FALSE(result.stopped);
  CHECK(result.minutes < 1.75);
  REQUIRE(result.points);
  CHECK(result.points->controller == "baseline");
  CHECK(result.points->trial_s == 6.0);
  REQUIRE(true_mm.size() >= 3);
  CHECK(result.points->failed.n == static_cast<std::int64_t>(true_mm.size()));
  REQUIRE(result.points->failed.value == 0.0);
  CHECK(result.points->failed.interval->at(1) > 0.3);  // so few say little
  REQUIRE(result.points->rms_mm);
  const double true_rms_mm = common::root_mean_square(true_mm);
  CHECK(result.points->rms_mm->value == Approx(true_rms_mm).margin(0.25));
  CHECK(result.points->sensed_rms_mm->value == Approx(true_rms_mm).margin(0.25));
  REQUIRE(result.points->rms_mm->interval);
  CHECK(result.points->rms_mm->interval->at(0) <= result.points->rms_mm->value);
  CHECK(result.points->rms_mm->interval->at(1) >= result.points->rms_mm->value);
  CHECK(*item_of(result, "error to expect at points (RMS)").value == result.points->rms_mm->value);
}

TEST_CASE("a trial that would not end in time is not begun") {
  CHECK_FALSE(qualified(with_points(0.5, 16, 20.0)).points);
  const runs::QualificationResult some = qualified(with_points(1.0, 16, 4.0));
  REQUIRE(some.points);
  CHECK(some.points->failed.n >= 2);
  CHECK(some.points->failed.n < 9);
}

TEST_CASE("a trial that is stopped early is counted apart, and the next ones go on, over a gap, too") {
  experiments::QualificationConfig config = with_points(1.0, 8, 3.0);
  config.needle.loop.max_invalid_poses = 5;
  const tests::TemporaryFolder folder;
  BenchWithHalfACoil bench(config);
  session::RigSession opened = bench.open();
  {
    experiments::Qualification work(config, opened, experiments::points_source(config));
    common::MetricsLog metrics(folder.path());
    go_on(work, "points");
    work.step(metrics);
    bench.sensor().cover(5);
    work.step(metrics);
    work.save(folder.path());
  }
  CHECK(state_in(folder.path()).at("points_mm").size() == 1);
  CHECK(state_in(folder.path()).at("points_failed").get<int>() == 1);
  experiments::Qualification work(config, opened, experiments::points_source(config));
  work.load(folder.path());
  CHECK(work.progress().note == "points");
  go_on(work);
  const runs::QualificationResult result = work.result();
  CHECK_FALSE(result.stopped);
  REQUIRE(result.points);
  CHECK(result.points->failed.n >= 3);
  CHECK(result.points->failed.value == Approx(1.0 / static_cast<double>(result.points->failed.n)));
  REQUIRE(result.points->sensed_rms_mm);
  CHECK(result.points->sensed_rms_mm->n == result.points->failed.n - 1);
  REQUIRE(result.gaps.size() == 1);
  CHECK(result.gaps[0].across.value_or("") == "points");
}

TEST_CASE("a trial during which somebody stops the bench does not count") {
  const experiments::QualificationConfig config = with_points(1.0, 8, 2.0);
  const auto bench = experiments::make_qualification_session(config);
  experiments::Qualification work(config, *bench, experiments::points_source(config));
  go_on(work, "points");
  common::MetricsLog metrics("");  // nothing is written
  work.step(metrics);
  bench->coils().request_stop("somebody said so");
  go_on(work);
  const runs::QualificationResult result = work.result();
  REQUIRE(result.stopped);
  CHECK(result.stopped->find("somebody said so") != std::string::npos);
  REQUIRE(result.points);
  CHECK(result.points->failed.n == 1);
}

TEST_CASE("points are driven on the qualification's own rig, by what is named") {
  experiments::QualificationConfig config = with_points(1.0, 7, 8.0);
  config.rig_seed = 21;
  config.needle.loop.rest_s = 0.25;
  config.safety.max_current_A = 4.0;
  const experiments::DeployConfig deploy = config.deploy();
  CHECK(deploy.controller == "baseline");
  CHECK(deploy.task == "point");
  CHECK(deploy.deployment.rig_seed == 21);
  CHECK(deploy.deployment.loop.rest_s == 0.25);
  CHECK(deploy.deployment.safety.max_current_A == 4.0);
  CHECK(deploy.deployment.sensor.kind == "simulated");
  CHECK(deploy.deployment.trials.count == 7);
  CHECK(deploy.deployment.trials.point_seconds == 8.0);
  CHECK(experiments::points_source(config).name == "baseline");
  config.points.dynamics = "there";
  CHECK(config.deploy().controller == "planner");
  config.points.policy = "here";
  CHECK(config.deploy().controller == "policy");
  config.points.controller = "baseline";
  CHECK(config.deploy().controller == "baseline");
}

TEST_CASE("a controller without its checkpoint is refused before anything is measured") {
  const auto read = [](const char* controller, const char* key) {
    common::Json json;
    json["points"]["controller"] = controller;
    json["points"][key] = "there";
    return common::config_from_json<experiments::QualificationConfig>(json, "test");
  };
  CHECK(read("planner", "dynamics").points.dynamics == "there");
  CHECK_THROWS_WITH(read("planner", "policy"), Catch::Contains("points.controller"));
  CHECK_THROWS_WITH(read("policy", "dynamics"), Catch::Contains("points.policy"));
}
