#include "serial_link.h"

#include <catch2/catch.hpp>

#include "rig/firmware_port.h"

using namespace lodestone;
using tests::FirmwareBench;
using tests::FirmwarePort;

namespace {

struct Line {
  std::shared_ptr<FirmwareBench> bench = std::make_shared<FirmwareBench>();
  rig::SerialLink link{[this] { return std::make_unique<FirmwarePort>(bench); }, 0.05, 4};

  Line() { link.open(); }
  rig::SerialLink::Bytes hello() { return link.exchange(wire::kHello, {wire::kProtocolVersion, 1, 2, 3, 4}); }
};

}  // namespace

TEST_CASE("a request is repeated until it is answered, and no oftener than allowed") {
  Line line;
  CHECK(line.hello().size() == wire::kHelloReplySize);
  CHECK(line.link.repeats() == 0);
  line.bench->lose_replies = 1;
  CHECK(line.link.exchange(wire::kPing).empty());
  CHECK(line.link.repeats() == 1);
  line.bench->lose_replies = 1000;
  CHECK_THROWS_AS(line.link.exchange(wire::kPing), rig::LinkLost);
  CHECK(line.link.repeats() == 4);
}

TEST_CASE("a refusal says why; a port that is gone, and a forgotten session, are a lost link") {
  Line line;
  CHECK_THROWS_AS(line.link.exchange(wire::kPing), rig::LinkLost);  // no hello yet
  CHECK_THROWS_WITH(line.link.exchange(wire::kHello, {99, 1, 2, 3, 4}), Catch::Contains("speaks protocol 2"));
  line.hello();
  CHECK_THROWS_AS(line.link.exchange(wire::kPulse, {1, 2, 3}), rig::RequestRefused);
  line.bench->plugged = false;
  CHECK_THROWS_AS(line.link.exchange(wire::kPing), rig::LinkLost);
}

TEST_CASE("while a stop is asked for, a pulse is given up and a question still answered") {
  Line line;
  line.hello();
  const rig::SerialLink::StopRequest stop(line.link);
  CHECK_THROWS_WITH(line.link.exchange(wire::kPulse, rig::SerialLink::Bytes(wire::pulse_request_size(2))),
                    Catch::Contains("given up"));
  CHECK(line.link.exchange(wire::kStatus).size() == wire::coil_state_size(2));
}
