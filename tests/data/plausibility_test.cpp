#include "lodestone/data/plausibility.h"

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"
#include "lodestone/common/random.h"

using namespace lodestone;
using Catch::Matchers::Contains;

namespace {

/// A log of this many positions drawn in a disc, in this unit of headings.
data::MappedLog log_within(double radius_m, double turned_rad, const std::string& unit = "rad") {
  common::RandomStream random(1, "plausibility");
  data::MappedLog log;
  log.action_scale = 15.0;
  log.heading = true;
  log.most_turned_rad = turned_rad;
  log.columns = {{data::Quantity::kX, 1, "X", {"mm", 1e-3}, false},
                 {data::Quantity::kY, 2, "Y", {"mm", 1e-3}, false},
                 {data::Quantity::kHeading, 3, "A", {unit, 1.0}, false},
                 {data::Quantity::kCurrents, 4, "I", {"A", 1.0}, false}};
  for (int i = 0; i < 200; ++i) {
    data::LogSample sample;
    sample.pose.x_m = random.uniform(-radius_m, radius_m);
    sample.drive = {random.uniform(-15.0, 15.0), 0.0};
    sample.line = i + 2;
    log.samples.push_back(sample);
  }
  return log;
}

void check(const data::MappedLog& log) { data::check_sizes(data::sizes_of(log, 0.0425), 0.0425, "log.csv"); }

/// Steps whose motion is `turn` of their drive, with as much scatter.
data::Dataset dataset(const Eigen::Matrix2d& turn, int steps = 200) {
  common::RandomStream random(2, "directions");
  data::Dataset dataset;
  dataset.info.layout = data::StateLayout::kPosition;
  for (int i = 0; i < steps; ++i) {
    const geometry::Vector2 drive(random.uniform(-15.0, 15.0), random.uniform(-15.0, 15.0));
    const geometry::Vector2 moved =
        1e-4 * (turn * drive) + 1e-3 * geometry::Vector2(random.normal(), random.normal());
    data::Episode episode;
    episode.observations = {0.0, 0.0, moved.x(), moved.y()};
    episode.actions = {drive.x(), drive.y()};
    episode.terminations = {0};
    episode.truncations = {1};
    episode.zero_current = {0};
    dataset.episodes.push_back(episode);
  }
  return dataset;
}

Eigen::Matrix2d matrix(double a, double b, double c, double d) {
  return (Eigen::Matrix2d() << a, b, c, d).finished();
}

}  // namespace

TEST_CASE("sizes that fit the dish are taken") {
  CHECK_NOTHROW(check(log_within(0.03, 3.1)));
  CHECK_NOTHROW(check(log_within(0.03, 30.0)));  // turned round and round
}

TEST_CASE("sizes that cannot be are refused, with the columns they come from") {
  CHECK_THROWS_WITH(check(log_within(0.06, 3.1)), Contains("log.csv") &&
                                                      Contains("of 200 positions lie outside") &&
                                                      Contains("\"X\" (unit mm)"));
  CHECK_THROWS_WITH(check(log_within(3e-4, 3.1)), Contains("no position is further"));
  CHECK_THROWS_WITH(check(log_within(0.03, 180.0)), Contains("headings reach 180 rad"));
  CHECK_THROWS_WITH(check(log_within(0.03, 0.05, "deg")), Contains("all headings lie within 2.86"));
  data::MappedLog weak = log_within(0.03, 3.1);
  for (data::LogSample& sample : weak.samples) sample.drive *= 1e-3;
  CHECK_THROWS_WITH(check(weak), Contains("no current is above") && Contains("\"I\""));
}

TEST_CASE("motion towards the coils that are on is taken, any other way is named") {
  CHECK_NOTHROW(data::check_directions(dataset(matrix(1, 0, 0, 1)), "log.csv"));
  CHECK_NOTHROW(data::check_directions(dataset(matrix(0, 0, 0, 0)), "log.csv"));       // nobody can tell
  CHECK_NOTHROW(data::check_directions(dataset(matrix(-1, 0, 0, 1), 20), "log.csv"));  // too few
  CHECK_THROWS_WITH(data::check_directions(dataset(matrix(-1, 0, 0, 1)), "log.csv"),
                    Contains("x is the other way round"));
  CHECK_THROWS_WITH(data::check_directions(dataset(matrix(1, 0, 0, -1)), "log.csv"), Contains("y_down"));
  CHECK_THROWS_WITH(data::check_directions(dataset(matrix(-1, 0, 0, -1)), "log.csv"),
                    Contains("of each pair"));
  CHECK_THROWS_WITH(data::check_directions(dataset(matrix(0, 1, 1, 0)), "log.csv"),
                    Contains("are exchanged"));
  CHECK_THROWS_WITH(data::check_directions(dataset(matrix(0, -1, 1, 0)), "log.csv"),
                    Contains("turned by a quarter"));
}

TEST_CASE("a match is between -1 and 1, and is told with what would be better") {
  const data::DirectionMatch match = data::match_directions(dataset(matrix(-1, 0, 0, 1)));
  CHECK(match.driven == 200);
  CHECK(std::abs(match.as_is) < 0.2);
  CHECK(match.best > 0.4);
  CHECK(match.best <= 1.0);
}
