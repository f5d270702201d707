#include "lodestone/session/coil_wiring.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "lodestone/common/config.h"
#include "lodestone/rig/virtual_rig.h"
#include "lodestone/session/simulated_detector.h"
#include "lodestone/session/tracked_pose_sensor.h"

using namespace lodestone;
using Catch::Matchers::Contains;
using session::CoilWiring;

namespace {

/// Coils behind wires that somebody has mixed up.
class MiswiredCoils final : public rig::Coils {
 public:
  MiswiredCoils(rig::Coils& coils, const CoilWiring& wiring) : coils_(coils), wiring_(wiring) {}
  void apply(const rig::CoilPulse& pulse) override {
    rig::CoilPulse wired;
    wired.duration_s = pulse.duration_s;
    for (std::size_t asked = 0; asked < wiring_.coil.size(); ++asked)
      wired.current_A[static_cast<std::size_t>(wiring_.coil[asked])] =
          wiring_.sign[asked] * pulse.current_A[asked];
    coils_.apply(wired);
  }
  void stop() noexcept override { coils_.stop(); }
  rig::CoilStatus status() override { return coils_.status(); }

 private:
  rig::Coils& coils_;
  CoilWiring wiring_;
};

rig::RigConfig described(rig::DeviationWidth deviation = rig::DeviationWidth::kNone) {
  rig::RigConfig rig;
  rig.simulation.deviation = deviation;
  return rig;
}

using Fields = std::shared_ptr<const physics::CoilFields>;

/// Keeps fields, so that those of a rig are tabulated once.
Fields kept(Fields fields) {
  static std::vector<Fields> all;
  all.push_back(fields);
  return fields;
}

session::WiringInference nothing_known(const rig::RigConfig& rig = described()) {
  return {rig, kept(session::WiringInference::field_for(rig))};
}

/// A preset as it is described, behind drivers that a reversed coil does not stop.
rig::RigConfig preset(const std::string& name) {
  const std::string file = LODESTONE_SOURCE_DIR "/configs/rigs/" + name + ".json";
  rig::RigConfig rig = common::config_from_json<rig::RigConfig>(common::read_json_file(file), file);
  rig.simulation.deviation = rig::DeviationWidth::kNone;
  for (physics::CoilDescription& coil : rig.coils.each) coil.bipolar = true;
  return rig;
}

/// What is found out on a virtual rig that differs from its description.
session::WiringInference probe(const CoilWiring& wiring, const geometry::Pose2& start, std::uint64_t seed,
                               const rig::RigConfig& real = described()) {
  rig::VirtualRig rig(real, seed, kept(physics::CoilFields::shared(real.coils, real.dish.radius_m, 10e-3)));
  rig.place(start);
  MiswiredCoils coils(rig.coils(), wiring);
  session::SimulatedDetector detector([&rig] { return rig.true_pose(); }, rig.clock(), {}, {},
                                      common::RandomStream(seed, "sensor"));
  session::TrackedPoseSensor sensor(detector, {}, real, rig.clock());
  session::WiringInference inference = nothing_known(real);
  session::probe_wiring(inference, coils, sensor, rig.clock(), {});
  return inference;
}

void check_found(const CoilWiring& wiring, const geometry::Pose2& start, std::uint64_t seed,
                 const rig::RigConfig& real = described()) {
  const std::vector<CoilWiring> possible = probe(wiring, start, seed, real).possible().listed;
  CAPTURE(seed, wiring.coil, wiring.sign, possible.size());
  CHECK(possible == std::vector<CoilWiring>{wiring});
}

const geometry::Pose2 kOffCentre{0.010, -0.008, 2.0};

/// Nothing wrong, every single and double reversal, and every swap of two coils.
std::vector<CoilWiring> usual_mistakes() {
  std::vector<CoilWiring> mistakes(1);
  for (std::size_t a = 0; a < physics::kFourCoils; ++a) {
    mistakes.emplace_back().sign[a] = -1;
    for (std::size_t b = 0; b < a; ++b) {
      CoilWiring& reversed = mistakes.emplace_back();
      reversed.sign[a] = reversed.sign[b] = -1;
      CoilWiring& swapped = mistakes.emplace_back();
      std::swap(swapped.coil[a], swapped.coil[b]);
    }
  }
  return mistakes;
}

/// Nothing wrong, a reversal, a swap of neighbours, and a swap of opposite coils with a reversal beside it.
std::vector<CoilWiring> some_mistakes(std::size_t coils) {
  std::vector<CoilWiring> mistakes(4, CoilWiring(coils));
  mistakes[1].sign[1] = -1;
  std::swap(mistakes[2].coil[0], mistakes[2].coil[1]);
  std::swap(mistakes[3].coil[0], mistakes[3].coil[coils / 2]);
  mistakes[3].sign[2] = -1;
  return mistakes;
}

}  // namespace

TEST_CASE("every single and double reversal and every swap of two coils is found") {
  for (const CoilWiring& wiring : usual_mistakes()) {
    check_found(wiring, kOffCentre, 1);
    check_found(wiring, {0.0, 0.0, 0.0}, 2);  // as an emulated bench begins, with its head to +x already
  }
}

TEST_CASE("a rig that differs from its description is told right, too") {
  const rig::RigConfig real = described(GENERATE(rig::DeviationWidth::kLab, rig::DeviationWidth::kWide));
  for (const CoilWiring& wiring : usual_mistakes()) check_found(wiring, {-0.015, 0.005, -1.2}, 3, real);
}

TEST_CASE("every one of the 384 wirings is found") {
  for (const CoilWiring& wiring : nothing_known().possible().listed) check_found(wiring, kOffCentre, 4);
}

TEST_CASE("of six coils reversals and swaps are found, of eight they are among those that are left") {
  const rig::RigConfig real = preset(GENERATE(as<std::string>{}, "six_planar", "eight_tilted"));
  const std::size_t coils = real.coils.count();
  for (const CoilWiring& wiring : some_mistakes(coils)) {
    const std::vector<CoilWiring> possible = probe(wiring, kOffCentre, 5, real).possible().listed;
    CAPTURE(wiring.coil, wiring.sign, possible.size());
    CHECK(possible.size() <= (coils == 6 ? 4U : 200U));
    CHECK(std::find(possible.begin(), possible.end(), wiring) != possible.end());
  }
}

TEST_CASE("of six coils mostly one wiring is left, of eight several", "[slow]") {
  const bool six = GENERATE(true, false);
  const rig::RigConfig real = preset(six ? "six_planar" : "eight_tilted");
  const std::vector<CoilWiring> mistakes = some_mistakes(real.coils.count());
  int tries = 0, alone = 0;
  for (std::uint64_t seed = 1; seed <= 15; ++seed)
    for (const CoilWiring& wiring : mistakes) {
      const std::vector<CoilWiring> possible = probe(wiring, kOffCentre, seed, real).possible().listed;
      CAPTURE(seed, wiring.coil, wiring.sign, possible.size());
      CHECK(std::find(possible.begin(), possible.end(), wiring) != possible.end());
      ++tries;
      alone += possible.size() == 1 ? 1 : 0;
    }
  WARN(real.coils.count() << " coils: the true wiring alone in " << alone << " of " << tries << " tries");
  if (six)
    CHECK(alone > tries / 2);
  else
    CHECK(alone < tries / 2);
}

TEST_CASE("coils are asked for in an order in which each field lies across the one before") {
  CHECK(session::crossing_order(described()) == std::vector<int>{0, 2, 1, 3});
  const std::vector<int> six = session::crossing_order(preset("six_planar"));
  REQUIRE(six.size() == 6);
  CHECK(std::set<int>(six.begin(), six.end()).size() == 6);
  for (std::size_t i = 1; i < six.size(); ++i) CHECK((six[i] - six[i - 1] + 6) % 3 != 0);  // nor along it
}

TEST_CASE("there are 384 wirings, and all of them are possible before anything has moved") {
  session::WiringInference inference = nothing_known();
  CHECK(inference.possible().listed.size() == 384);
  CHECK_FALSE(inference.add({0, 5.0, kOffCentre, kOffCentre}));
  CHECK(inference.possible().open() == 384);
  CHECK(inference.moved(0) == 0);
  CHECK_THAT(session::wiring_remedy(inference, described()),
             Contains("384 wirings") && Contains("off the centre"));
}

TEST_CASE("heading alone leaves a reversed coil and the opposite one; the pull tells them apart") {
  session::WiringInference inference = nothing_known();
  // Off the centre, a needle across turns its head to +x and stays where it is.
  for (const double before_rad : {1.5, -1.5, 1.5, -1.5})
    inference.add({0, 5.0, {0.005, 0.002, before_rad}, {0.005, 0.002, 0.0}});
  CHECK(session::possible_answers(inference.possible(), 0, described().coils) ==
        "coil +x, or coil -x reversed");
  // Then it is drawn to -x, with its head still to +x.
  for (int i = 0; i < 3; ++i) inference.add({0, 5.0, {0.005, 0.002, 0.0}, {0.001, 0.002, 0.0}});
  CHECK(session::possible_answers(inference.possible(), 0, described().coils) == "coil -x reversed");
  CHECK(inference.explained());
}

TEST_CASE("where the needle sticks, the wirings that are still possible are named") {
  rig::RigConfig sticky = described();
  sticky.friction.static_coefficient *= 20.0;
  sticky.friction.kinetic_coefficient *= 20.0;
  const session::WiringInference inference = probe({}, kOffCentre, 1, sticky);
  CHECK(inference.possible().open() > 1);
  CHECK_FALSE(session::wiring_remedy(inference, described()).empty());
}

TEST_CASE("motion that no coil makes is not explained") {
  session::WiringInference inference = nothing_known();
  for (int i = 0; i < 10; ++i) {
    const double heading_rad = 0.8 * i;
    inference.add({i % 4, 5.0, {0.0, 0.0, heading_rad}, {0.003, 0.0, heading_rad + 0.8}});
    inference.add({i % 4, 5.0, {0.003, 0.0, heading_rad}, {0.0, 0.0, heading_rad + 2.5}});
  }
  CHECK_FALSE(inference.explained());
  CHECK_THAT(session::wiring_remedy(inference, described()), Contains("fits no wiring"));
}

TEST_CASE("the remedy makes every coil answer as asked, also where the configuration is not the default") {
  rig::RigConfig rig = described();
  rig.serial.output = {3, 2, 1, 4};
  rig.coils.polarity = {1, -1, 1, 1};
  CoilWiring found;
  found.coil = {1, 0, 2, 3};
  found.sign = {1, -1, 1, 1};
  const rig::RigConfig right = session::rewired(rig, found);
  CHECK(right.serial.output == std::vector<std::int64_t>{2, 3, 1, 4});
  CHECK(right.coils.polarity == std::vector<std::int64_t>{1, 1, 1, 1});
  right.validate();
  rig.serial.output.clear();  // 1, 2, 3, 4
  CHECK(session::rewired(rig, found).serial.output == std::vector<std::int64_t>{2, 1, 3, 4});
}
