#include "lodestone/session/rig_check.h"

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"
#include "lodestone/emulation/live_bench.h"
#include "sphere_rig.h"

using namespace lodestone;

namespace {

/// Nobody stands at the rig; every question has one answer.
class FakeDialogue final : public session::Dialogue {
 public:
  explicit FakeDialogue(bool answer) : answer_(answer) {}
  void say(const std::string& text) override { said += text; }
  bool confirm(const std::string& question) override {
    asked += question + "\n";
    return answer_;
  }
  bool attended() const override { return false; }
  std::string said;
  std::string asked;

 private:
  bool answer_;
};

}  // namespace

TEST_CASE("a bench that is not there is said with what there is") {
  session::RigCheckConfig config;
  config.rig.serial.port = "/dev/ttyNOTHING";
  FakeDialogue dialogue(true);
  CHECK_THROWS_AS(session::check_rig(config, {false, false}, dialogue), common::HardwareError);
  CHECK_THAT(dialogue.said, Catch::StartsWith("serial ports:"));
  CHECK(dialogue.asked.empty());
}

TEST_CASE("a sphere tells nothing of the wiring") {
  session::RigCheckConfig config;
  config.rig.needle = tests::sphere();
  FakeDialogue dialogue(true);
  CHECK_THROWS_WITH(session::check_rig(config, {true, false}, dialogue),
                    Catch::Contains("rig.needle.shape = sphere"));
  CHECK(dialogue.said.empty());
}

TEST_CASE("coils that nobody lets be energised are left out, and the bench is not called ready") {
  std::optional<emulation::LiveBench> bench;
  try {
    bench.emplace(rig::VirtualRigConfig{}, 1);
  } catch (const common::HardwareError& error) {
    WARN("left out: " << error.what());
    return;
  }
  session::RigCheckConfig config;
  config.rig.serial.port = bench->port();
  FakeDialogue dialogue(false);
  CHECK_THROWS_WITH(session::check_rig(config, {false, false}, dialogue), Catch::Contains("not ready"));
  CHECK_THAT(dialogue.said, Catch::Contains("coil controller        firmware"));
  CHECK_THAT(dialogue.said, Catch::Contains("supply                 34"));
  CHECK_THAT(dialogue.said, Catch::Contains("emergency stop         closed"));
  CHECK_THAT(dialogue.said, Catch::Contains("coil -y                left out"));
  CHECK_THAT(dialogue.asked, Catch::Contains("energise coil +x with 3.0 A"));
}
