#pragma once

#include <string>

#include "lodestone/rig/camera_source.h"
#include "lodestone/rig/driver_config.h"
#include "lodestone/rig/serial_coils.h"
#include "lodestone/rig/virtual_rig.h"

namespace lodestone::rig {

/// What drives the rig: the simulated one, the coil controller on a serial line, or a program of the
/// laboratory's own.
enum class Backend { kVirtual, kSerial, kDriver };
inline std::vector<std::string> names_of(Backend) { return {"virtual", "serial", "driver"}; }

/// The rig of a run: what is known of it, what drives it, and what stands in for it where it is virtual. This
/// is what `rig.json` holds.
struct RigConfig : VirtualRigConfig {
  Backend backend = Backend::kVirtual;
  SerialConfig serial;
  DriverConfig driver;
  CameraSourceConfig camera;

  bool real() const { return backend != Backend::kVirtual; }
  template <class Visitor>
  void visit(Visitor& v) {
    v.field(
        "backend", backend, "",
        "virtual: a simulated rig with its own camera; serial: the coil controller on rig.serial.port under "
        "the camera of rig.camera; driver: the same with a program of your own, rig.driver.coils");
    VirtualRigConfig::visit(v);
    v.group("serial", serial, "the line to the coil controller");
    v.group("driver", driver, "programs of your own that drive the rig or see its needle");
    v.group("camera", camera, "the camera of a real rig");
  }
};

}  // namespace lodestone::rig
