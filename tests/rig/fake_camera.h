#pragma once

#include "lodestone/common/error.h"
#include "lodestone/rig/camera.h"

namespace lodestone::tests {

/// Hands out grey images, one every 33 ms of its own time, until it is told to fall silent.
class FakeCamera final : public rig::Camera {
 public:
  imaging::Frame grab(double timeout_s) override {
    if (silent)
      throw common::HardwareError("fake camera: no frame within " + std::to_string(timeout_s) + " s");
    now_s_ += 0.033;
    return {cv::Mat(cv::Size(64, 48), CV_8UC3, cv::Scalar(128, 128, 128)), now_s_};
  }

  bool silent = false;

 private:
  double now_s_ = 0.0;
};

}  // namespace lodestone::tests
