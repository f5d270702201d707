#pragma once

#include <string>

#include "lodestone/rig/camera_source.h"
#include "lodestone/rig/serial_coils.h"
#include "lodestone/rig/virtual_rig.h"

namespace lodestone::rig {

/// The rig of a run: which coils are driven, the virtual rig's figures (they describe dish, coils and needle
/// of a real bench, too), and how a real bench is connected.
struct RigConfig : VirtualRigConfig {
  std::string coils = "simulated";
  SerialConfig serial;
  CameraSourceConfig camera;

  bool real() const { return coils == "serial"; }
  template <class Visitor>
  void visit(Visitor& v) {
    v.field("coils", coils, "",
            "simulated: the virtual rig with its own camera; serial: the coil controller on rig.serial.port "
            "under "
            "the camera of rig.camera",
            {"simulated", "serial"});
    VirtualRigConfig::visit(v);
    v.group("serial", serial, "the coil controller and its coils");
    v.group("camera", camera, "the camera of a real bench");
  }
  void validate() const {
    VirtualRigConfig::validate();
    serial.validate();
  }
};

}  // namespace lodestone::rig
