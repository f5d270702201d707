#include "lodestone/console/bench.h"

#include "console/laboratory.h"

using namespace lodestone;
using console::BenchState;
using console::Mode;
using tests::Laboratory;
using tests::point;

TEST_CASE("what was asked for before is not done later: a goal from before, a wish, a stop in between") {
  Laboratory lab;
  REQUIRE(lab.reach(Mode::kDisarmed));
  REQUIRE(lab.arm().empty());
  REQUIRE(lab.bench->set_unattended(true).empty());
  lab.bench->handed_over(true);
  CHECK_FALSE(lab.bench->state().unattended);  // who wished for it has gone
  REQUIRE(lab.bench->drive(point(0.01, 0.0)).empty());
  lab.bench->stop("before it began");
  REQUIRE(lab.reach(Mode::kStopped));
  CHECK(lab.told("coils off, as measured"));
  // Said again while it is being re-armed: whichever comes first, it is stopped, or armed before that stop.
  std::string why_not;
  std::atomic<bool> answered{false};
  lab.bench->rearm("before it began", false, [&](const std::string& text) {
    why_not = text;
    answered = true;
  });
  lab.bench->stop("again");
  while (!answered) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  CHECK(lab.reach(Mode::kStopped));
  const std::string reason = lab.bench->state().reason;
  CHECK(lab.reach([](const BenchState& state) { return state.why_not.empty(); }));
  CHECK(lab.rearm(reason).empty());
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  CHECK(lab.bench->state().mode == Mode::kArmed);  // the old goal does not drive
}
