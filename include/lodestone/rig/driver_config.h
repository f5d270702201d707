#pragma once

#include <string>

namespace lodestone::rig {

/// What drives a rig, or sees its needle, from a program of the laboratory's own (docs/driver-protocol.md).
struct DriverConfig {
  std::string coils;
  std::string sensor;
  double reply_timeout_s = 0.2;
  double start_timeout_s = 5.0;
  double max_pulse_s = 0.5;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("coils", coils, "",
            "the coils' driver, where rig.backend is driver: process:COMMAND, which is started, or "
            "tcp://HOST:PORT, which waits");
    v.field("sensor", sensor, "",
            "a driver that says where the needle is, in place of the camera: process:COMMAND or "
            "tcp://HOST:PORT; empty: none");
    v.field("reply_timeout_s", reply_timeout_s, "s", "how long an answer may take", {0.01, 1.0});
    v.field("start_timeout_s", start_timeout_s, "s", "how long a driver may take to get ready", {0.1, 120.0});
    v.field("max_pulse_s", max_pulse_s, "s", "the driver is told to refuse longer pulses", {0.001, 10.0});
  }
};

}  // namespace lodestone::rig
