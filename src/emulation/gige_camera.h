#pragma once

#include <functional>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>

namespace lodestone::emulation {

/// A GigE Vision camera on the loopback that shows whatever it is given.
class GigeCamera {
 public:
  /// `image` gives 8-bit BGR of the size asked for; it is called from the camera's thread, and an empty
  /// image sends the last one again. Throws HardwareError when its port (UDP 3956) is in use or Aravis is
  /// not built in.
  explicit GigeCamera(std::function<cv::Mat()> image);
  ~GigeCamera();
  GigeCamera(const GigeCamera&) = delete;
  GigeCamera& operator=(const GigeCamera&) = delete;

  const std::string& name() const;
  const std::string& serial() const;  ///< differs from that of every other emulated camera

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lodestone::emulation
