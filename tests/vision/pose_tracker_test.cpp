#include "lodestone/vision/pose_tracker.h"
#include "lodestone/physics/per_coil.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "lodestone/geometry/angle.h"
#include "sphere_rig.h"

using namespace lodestone;
using geometry::Pose2;
using vision::PoseTracker;
using vision::Rod;

namespace {

const physics::PerCoil kPullToX = {8.0, 0.0, 0.0, 0.0};

Rod rod(const Pose2& pose, double tape = 10.0) {
  Rod rod;
  rod.found = rod.axis_found = true;
  rod.pose = pose;
  rod.tape_log_odds = tape;
  rod.covariance.diagonal() << 5e-9, 5e-9, 7e-6;
  return rod;
}

vision::Track see(PoseTracker& tracker, const std::vector<Rod>& rods) { return tracker.see({0.0, rods, ""}); }

/// Up to three looks.
vision::Track insist(PoseTracker& tracker, const Rod& rod) {
  vision::Track track = see(tracker, {rod});
  for (int again = 0; again < 2 && !track.seen; ++again) track = see(tracker, {rod});
  return track;
}

/// A tracker that has seen the needle there.
PoseTracker tracking(const Pose2& pose) {
  PoseTracker tracker({}, {});
  for (int i = 0; i < 2; ++i) see(tracker, {rod(pose)});
  return tracker;
}

}  // namespace

TEST_CASE("a needle is expected where it lay, or along the pull") {
  PoseTracker tracker = tracking({0.0, 0.0, 0.0});
  tracker.pulse(kPullToX);
  REQUIRE(tracker.places().size() == 3);
  for (const vision::Place& place : tracker.places()) {
    CHECK(place.mean_m.x() >= 0.0);
    CHECK(std::abs(place.mean_m.y()) < 1e-4);
  }
}

TEST_CASE("however often it was not seen, it is at no more than four places, and their weights are all") {
  PoseTracker tracker = tracking({0.01, 0.005, 0.3});
  for (int pulse = 0; pulse < 8; ++pulse) {
    tracker.pulse({0.0, 0.0, 1.0 + pulse, 0.0});
    CHECK(tracker.places().size() <= 4);
    double sum = 0.0;
    for (const vision::Place& place : tracker.places()) sum += place.weight;
    CHECK(sum == Approx(1.0));
  }
  CHECK(insist(tracker, rod({0.01, 0.008, 1.5})).located);
  CHECK(tracker.places().size() == 1);
}

TEST_CASE("what is seen where the needle cannot have come is not believed, until it stays there") {
  PoseTracker tracker = tracking({0.0, 0.0, 0.0});
  const Rod elsewhere = rod({-0.03, 0.01, 1.0});
  CHECK_FALSE(see(tracker, {elsewhere}).located);
  CHECK(see(tracker, {rod({0.0, 0.0, 0.0})}).seen);  // it was a reflection
  CHECK_FALSE(see(tracker, {elsewhere}).located);
  CHECK_FALSE(see(tracker, {rod({0.02, 0.02, 1.0})}).located);  // another one
  CHECK_FALSE(see(tracker, {elsewhere}).located);
  CHECK_FALSE(see(tracker, {elsewhere}).located);
  const vision::Track moved = see(tracker, {elsewhere});  // somebody has moved it
  CHECK(moved.seen);
  CHECK(moved.pose.x_m == Approx(-0.03));
}

TEST_CASE("a needle that is new, or has slipped far, is looked at twice") {
  PoseTracker tracker({}, {});
  CHECK_FALSE(see(tracker, {rod({0.0, 0.0, 0.2})}).located);
  CHECK(see(tracker, {rod({0.0, 0.0, 0.2})}).seen);
  tracker.pulse({12.0, 0.0, 0.0, 0.0});
  const Rod far = rod({0.014, 0.001, 0.1});
  CHECK_FALSE(see(tracker, {far}).located);
  CHECK(see(tracker, {far}).seen);
}

TEST_CASE("weak pulses between looks do not keep a needle that was moved from being found") {
  PoseTracker tracker = tracking({0.0, 0.0, 0.0});
  vision::Track track;
  for (int step = 0; step < 3 && !track.located; ++step) {
    track = see(tracker, {rod({-0.025, 0.01, 1.0 + 0.3 * step})});
    tracker.pulse({1.0, 0.0, 0.0, 0.0});
  }
  CHECK(track.located);
}

TEST_CASE("of several candidates the likeliest is taken, and none where two are likely") {
  PoseTracker tracker = tracking({0.0, 0.0, 0.0});
  const vision::Track one = see(tracker, {rod({0.02, 0.0, 0.5}), rod({0.0, 0.0, 0.0})});
  CHECK(one.seen);
  CHECK(one.pose.x_m == Approx(0.0).margin(1e-4));
  tracker.pulse(kPullToX);
  CHECK_FALSE(see(tracker, {rod({0.0015, 0.0005, 0.0}), rod({0.0015, -0.0005, 0.0})}).located);
  PoseTracker fresh({}, {});
  CHECK_FALSE(see(fresh, {rod({0.02, 0.0, 0.5}), rod({0.0, 0.0, 0.0})}).located);
}

TEST_CASE("a sphere needs no head to be seen, and has no heading whatever is said of one") {
  const physics::RigDescription rig = tests::sphere_rig();
  PoseTracker tracker({}, rig);
  Rod seen = rod({0.0, 0.0, 2.0}, /*tape=*/0.0);
  CHECK_FALSE(see(tracker, {seen}).located);
  vision::Track track = see(tracker, {seen});
  CHECK(track.seen);
  CHECK_FALSE(track.either_way);
  CHECK(track.pose.heading_rad == 0.0);
  CHECK(track.covariance(2, 2) == 0.0);
  CHECK(track.covariance(0, 0) > 0.0);
  tracker.pulse(kPullToX);
  seen = rod({0.003, 0.0, -1.0}, 0.0);
  track = insist(tracker, seen);
  CHECK(track.seen);
  CHECK(track.pose.x_m == Approx(0.003).margin(0.5e-3));
  CHECK(track.pose.heading_rad == 0.0);
  // It comes as near to the wall as a radius.
  tracker.forget();
  CHECK(insist(tracker, rod({0.0, 0.0405, 0.0}, 0.0)).seen);
}

TEST_CASE("what reaches through the wall is no needle") {
  const physics::RigDescription rig;
  const double furthest_m = rig.dish.radius_m - 0.5 * rig.needle.length_m;
  PoseTracker tracker({}, rig);
  CHECK(insist(tracker, rod({furthest_m + 0.5e-3, 0.0, 0.0})).seen);  // an image may err
  tracker.forget();
  const vision::Track outside = insist(tracker, rod({furthest_m + 3e-3, 0.0, 0.0}));
  CHECK_FALSE(outside.located);
  CHECK_THAT(outside.reason, Catch::Contains("wall"));
}

TEST_CASE("images of a needle that lies still never make its place certain") {
  PoseTracker tracker = tracking({0.01, 0.0, 0.0});
  for (int image = 0; image < 5000; ++image) {
    const vision::Track track = see(tracker, {rod({0.01, 0.0, 0.0})});
    REQUIRE(track.seen);
    CHECK(track.covariance.topLeftCorner<2, 2>().trace() >= 0.999e-8);
    CHECK(track.covariance(2, 2) >= std::pow(0.149 * geometry::kRadPerDeg, 2));
  }
}

TEST_CASE("one image with the tape at the wrong end turns no needle") {
  PoseTracker tracker = tracking({0.0, 0.0, 0.2});
  const auto right = [](const vision::Track& track) {
    return !track.seen || std::cos(track.pose.heading_rad) > 0.0;
  };
  CHECK(right(see(tracker, {rod({0.0, 0.0, 0.2 - geometry::kPi})})));
  tracker.pulse(kPullToX);
  CHECK(right(see(tracker, {rod({0.001, 0.0, 0.1 - geometry::kPi})})));
  const vision::Track shown = see(tracker, {rod({0.001, 0.0, 0.1})});
  CHECK(shown.seen);
  CHECK(shown.pose.heading_rad == Approx(0.1).margin(1e-6));
}

// A needle that sticks one time in five, and is pulled half as strongly again as the description says.
TEST_CASE("how far a pull moves it is learned, so that surprises are as large as expected") {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const physics::RigDescription rig;
  const vision::CommandedField field(rig);
  PoseTracker tracker = tracking({0.0, 0.0, 0.0});
  geometry::Vector2 at_m(0.0, 0.0);
  double sum = 0.0;
  int count = 0;
  for (int step = 0; step < 3000; ++step) {
    physics::PerCoil current_A{};
    current_A[(at_m.x() > 0.0 ? 1U : 0U)] = 1.0 + 3.0 * unit(random);
    current_A[(at_m.y() > 0.0 ? 3U : 2U)] = 1.0 + 3.0 * unit(random);
    const geometry::Vector2 pull = field.pull_N(current_A, at_m) / rig.breakaway_N();
    tracker.pulse(current_A);
    const double ratio = 1.5 * pull.norm();
    if (unit(random) > 0.2)
      at_m += 3.3e-3 * ratio * ratio * (1.0 + 0.4 * normal(random)) * pull.normalized() +
              0.4e-3 * geometry::Vector2(normal(random), normal(random));
    const geometry::Vector2 seen_m = at_m + 0.07e-3 * geometry::Vector2(normal(random), normal(random));
    const vision::Track track = insist(tracker, rod({seen_m.x(), seen_m.y(), 0.0}));
    if (step < 300 || !tracker.innovation()) continue;
    CHECK((!track.located || std::abs(track.pose.x_m - at_m.x()) < 1e-3));
    sum += std::min(*tracker.innovation(), 30.0);
    ++count;
  }
  CHECK(count > 2600);
  CHECK(sum / count > 1.4);
  CHECK(sum / count < 2.6);
}

TEST_CASE("of things that look like a needle that nobody has seen, it is the one that a pulse moves") {
  const Rod other = rod({-0.01, 0.015, 0.5});
  const Rod lay = rod({0.005, -0.01, 1.2});
  const Rod turned = rod({0.0055, -0.0105, 0.4});
  PoseTracker tracker({}, {});
  for (int i = 0; i < 3; ++i) CHECK_FALSE(see(tracker, {other, lay}).located);
  tracker.pulse(kPullToX);
  SECTION("it has turned") {
    see(tracker, {other, turned});
    const vision::Track track = see(tracker, {other, turned});
    CHECK(track.located);
    CHECK(track.pose.x_m == Approx(0.0055));
    tracker.pulse(kPullToX);
    CHECK(see(tracker, {other, turned}).pose.x_m == Approx(0.0055));  // from here on as ever
  }
  SECTION("nothing has moved, or everything") {
    for (int i = 0; i < 3; ++i) CHECK_FALSE(see(tracker, {other, lay}).located);
    const Rod elsewhere = rod({0.02, 0.0, 0.0});
    for (int i = 0; i < 3; ++i) CHECK_FALSE(see(tracker, {elsewhere, turned}).located);
  }
  SECTION("somebody has taken it out since") {
    tracker.forget();
    for (int i = 0; i < 3; ++i) CHECK_FALSE(see(tracker, {other, turned}).located);
  }
}

TEST_CASE("while the needle is hidden, nothing is taken for it that lies still") {
  const Rod lay = rod({0.0, 0.0, 0.0});
  const std::vector<Rod> decoys = {rod({-0.025, 0.01, 0.5}), rod({0.005, 0.03, 1.4}),
                                   rod({0.02, -0.02, 2.6})};
  const std::size_t count = GENERATE(std::size_t{1}, std::size_t{3});
  const std::vector<Rod> still(decoys.begin(), decoys.begin() + static_cast<std::ptrdiff_t>(count));
  PoseTracker tracker = tracking(lay.pose);
  tracker.pulse({1.0, 0.0, 0.0, 0.0});
  for (int step = 0; step < 6; ++step) {
    INFO("step " << step);
    for (int look = 0; look < 3; ++look) CHECK_FALSE(see(tracker, still).located);
    tracker.pulse({step % 2 == 0 ? 1.0 : 0.0, 0.0, 1.0, 0.0});
  }
  std::vector<Rod> with_needle = still;
  SECTION("it comes back where it was") {
    with_needle.push_back(lay);
    CHECK(see(tracker, with_needle).located);
  }
  SECTION("it comes back elsewhere, and the next pulse turns it") {
    with_needle.push_back(rod({-0.02, -0.02, 1.0}));
    for (int look = 0; look < 3; ++look) CHECK_FALSE(see(tracker, with_needle).located);
    tracker.pulse({1.0, 0.0, 0.0, 0.0});
    with_needle.back() = rod({-0.02, -0.02, 0.4});
    vision::Track track;
    for (int look = 0; look < 3; ++look) track = see(tracker, with_needle);
    CHECK(track.located);
    CHECK(track.pose.x_m == Approx(-0.02));
  }
  SECTION("it comes back elsewhere and sticks at first") {
    with_needle.push_back(rod({-0.02, -0.02, 1.0}));
    for (int pulse = 0; pulse < 2; ++pulse) {
      for (int look = 0; look < 3; ++look) CHECK_FALSE(see(tracker, with_needle).located);
      tracker.pulse({1.0, 0.0, 0.0, 0.0});
    }
    with_needle.back() = rod({-0.02, -0.02, 0.4});
    vision::Track track;
    for (int look = 0; look < 3; ++look) track = see(tracker, with_needle);
    CHECK(track.located);
  }
}

TEST_CASE("a needle that sticks where it is expected is no background") {
  PoseTracker tracker = tracking({0.0, 0.0, 0.0});
  const Rod decoy = rod({0.02, -0.02, 2.6});
  for (int pulse = 0; pulse < 5; ++pulse) {
    tracker.pulse({0.0, 0.0, 1.0, 0.0});
    CHECK(see(tracker, {decoy, rod({0.0, 0.0, 0.0})}).located);
  }
  for (int pulse = 0; pulse < 3; ++pulse) {  // nor after it was hidden
    tracker.pulse({0.0, 0.0, 1.0, 0.0});
    CHECK_FALSE(see(tracker, {decoy}).located);
  }
  CHECK(insist(tracker, rod({0.0, 0.0, 0.0})).located);
}

TEST_CASE("a needle that a pulse cut short has not moved is one all the same") {
  const physics::PerCoil strong = {15.0, 0.0, 0.0, 0.0};
  const Rod slid = rod({0.015, 0.002, 0.0});
  PoseTracker tracker = tracking({-0.015, 0.0, 0.0});
  SECTION("where it came further than expected") {
    const Rod moved = rod({-0.015, 0.012, 0.4});
    tracker.pulse({0.0, 0.0, 1.0, 0.0});
    REQUIRE(insist(tracker, moved).located);
    const bool cut = GENERATE(true, false);
    for (int pulse = 0; pulse < 3; ++pulse) {
      tracker.pulse(strong);
      if (cut) tracker.pulse_cut();
      const bool located = see(tracker, {moved}).located;
      INFO("pulse " << pulse << (cut ? ", cut" : ""));
      if (cut) CHECK(located);
    }
    CHECK(see(tracker, {moved}).located == cut);
  }
  SECTION("or where it is one of several that nobody knows") {
    tracker.forget();
    for (int look = 0; look < 3; ++look) see(tracker, {slid, rod({-0.01, 0.02, 1.0})});
    tracker.pulse(strong);
    tracker.pulse_cut();
    see(tracker, {slid, rod({-0.01, 0.02, 1.0})});
    CHECK(insist(tracker, slid).located);  // none of both is background yet
  }
  SECTION("and its head is where it was") {
    tracker.pulse({0.0, 15.0, 0.0, 0.0});  // the field would turn it about
    tracker.pulse_cut();
    const vision::Track track = see(tracker, {rod({-0.015, 0.0, 0.0}, 3.0)});  // the tape says so, not surely
    CHECK(track.seen);
    CHECK(std::abs(track.pose.heading_rad) < 0.1);
  }
  double sum = 0.0;
  for (const vision::Place& place : tracker.places()) sum += place.weight;
  CHECK(sum == Approx(tracker.places().empty() ? 0.0 : 1.0));
}

TEST_CASE("after a pulse cut short the needle may lie where it lay, or wherever that takes it") {
  PoseTracker tracker = tracking({0.0, 0.0, 0.0});
  tracker.pulse(kPullToX, {{1.0, {0.006, 0.0, 0.0}, 0.2e-3, 0.2e-3, 0.05}});
  tracker.pulse_cut();
  CHECK(tracker.places().size() <= 4);
  double stayed = 0.0, sum = 0.0;
  for (const vision::Place& place : tracker.places()) {
    sum += place.weight;
    if (std::abs(place.mean_m.x()) < 0.5e-3) stayed += place.weight;
  }
  CHECK(sum == Approx(1.0));
  CHECK(stayed > 0.4);
  const double x_m = GENERATE(0.0, 0.003, 0.006);
  CHECK(insist(tracker, rod({x_m, 0.0, 0.0})).located);
  tracker.pulse_cut();  // of a pulse that a look came after
  CHECK(see(tracker, {rod({x_m, 0.0, 0.0})}).located);
}

TEST_CASE("where a learned simulator says what a pulse does, the needle is expected there") {
  PoseTracker tracker = tracking({0.0, 0.0, 0.0});
  const std::vector<physics::PulseOutcome> outcomes = {{0.7, {0.004, 0.001, 0.8}, 0.5e-3, 0.5e-3, 0.2},
                                                       {0.3, {0.0, 0.0, 0.0}, 0.1e-3, 0.1e-3, 0.05}};
  tracker.pulse(kPullToX, outcomes);
  CHECK(tracker.places().front().mean_m.x() == Approx(0.004));
  CHECK(tracker.places().front().mean_m.y() == Approx(0.001));
  double sum = 0.0;
  for (const vision::Place& place : tracker.places()) sum += place.weight;
  CHECK(sum == Approx(1.0));
  SECTION("with the head where that says, though no tape is seen") {
    const vision::Track track = insist(tracker, rod({0.004, 0.001, 0.8 - geometry::kPi}, 0.0));
    CHECK(track.seen);
    CHECK(track.pose.heading_rad == Approx(0.8));
  }
  SECTION("or anywhere near after all") { CHECK(insist(tracker, rod({0.002, 0.001, 0.4})).seen); }
  SECTION("and from there by field and friction, while it is not seen") {
    tracker.pulse(kPullToX, outcomes);
    CHECK(tracker.places().front().mean_m.x() > 0.0);
    CHECK(insist(tracker, rod({0.005, 0.001, 0.6})).seen);
  }
}

TEST_CASE("an axis without a tape after a field from behind may be the needle either way") {
  PoseTracker tracker = tracking({0.0, 0.0, geometry::kPi});
  tracker.pulse(kPullToX);
  const vision::Track track = insist(tracker, rod({0.0005, 0.0, 0.5 * geometry::kPi}, 0.0));
  CHECK(track.located);
  CHECK(track.either_way);
  CHECK_FALSE(track.seen);
  const vision::Track shown = insist(tracker, rod({0.0005, 0.0, 0.5 * geometry::kPi}));
  CHECK(shown.seen);
  CHECK_FALSE(shown.either_way);
}

TEST_CASE(
    "what was taken for the needle is given up when it stays put through pulses that hardly any needle "
    "would") {
  const Rod scratch = rod({0.008, 0.004, 0.5});
  PoseTracker tracker = tracking({0.0, 0.0, 0.0});
  tracker.pulse({1.0, 0.0, 0.0, 0.0});
  for (int look = 0; look < 3; ++look) see(tracker, {scratch});
  REQUIRE_FALSE(tracker.places().empty());
  CHECK(tracker.places().front().mean_m.x() == Approx(0.008).margin(1e-4));
  const double strength_A = GENERATE(8.0, 0.3);
  INFO(strength_A << " A");
  vision::Track track;
  int pulses = 0;
  do {
    tracker.pulse({strength_A, 0.0, 0.0, 0.0});
    track = see(tracker, {scratch});
  } while (track.located && ++pulses < 10);
  CHECK(track.located == (strength_A < 1.0));  // a weak pulse says nothing
  if (track.located) return;
  CHECK(pulses <= 3);
  const Rod needle = rod({-0.01, 0.0, 0.2});
  for (int look = 0; look < 3; ++look) track = see(tracker, {scratch, needle});
  CHECK(track.located);
  CHECK(track.pose.x_m == Approx(-0.01));
}
