#pragma once

#include <string>

#include "lodestone/rig/camera_source.h"
#include "lodestone/rig/serial_coils.h"
#include "lodestone/rig/virtual_rig.h"

namespace lodestone::rig {

/// The rig of a run: what is known of it, what drives it, and what stands in for it where it is virtual. This
/// is what `rig.json` holds.
struct RigConfig : VirtualRigConfig {
  std::string backend = "virtual";
  SerialConfig serial;
  CameraSourceConfig camera;

  bool real() const { return backend == "serial"; }
  void validate() const {
    VirtualRigConfig::validate();
    serial.validate();
  }
  template <class Visitor>
  void visit(Visitor& v) {
    v.field(
        "backend", backend, "",
        "virtual: a simulated rig with its own camera; serial: the coil controller on rig.serial.port under "
        "the camera of rig.camera",
        {"virtual", "serial"});
    VirtualRigConfig::visit(v);
    v.group("serial", serial, "the line to the coil controller");
    v.group("camera", camera, "the camera of a real rig");
  }
};

}  // namespace lodestone::rig
