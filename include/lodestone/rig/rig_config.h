#pragma once

#include <string>

#include "lodestone/rig/camera_source.h"
#include "lodestone/rig/serial_coils.h"
#include "lodestone/rig/virtual_rig.h"

namespace lodestone::rig {

/// What drives the rig: the simulated one, or the coil controller on a serial line.
enum class Backend { kVirtual, kSerial };
inline std::vector<std::string> names_of(Backend) { return {"virtual", "serial"}; }

/// The rig of a run: what is known of it, what drives it, and what stands in for it where it is virtual. This
/// is what `rig.json` holds.
struct RigConfig : VirtualRigConfig {
  Backend backend = Backend::kVirtual;
  SerialConfig serial;
  CameraSourceConfig camera;

  bool real() const { return backend == Backend::kSerial; }
  template <class Visitor>
  void visit(Visitor& v) {
    v.field(
        "backend", backend, "",
        "virtual: a simulated rig with its own camera; serial: the coil controller on rig.serial.port under "
        "the camera of rig.camera");
    VirtualRigConfig::visit(v);
    v.group("serial", serial, "the line to the coil controller");
    v.group("camera", camera, "the camera of a real rig");
  }
};

}  // namespace lodestone::rig
