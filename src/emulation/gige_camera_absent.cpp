#include "gige_camera.h"
#include "lodestone/common/error.h"

namespace lodestone::emulation {

struct GigeCamera::State {
  std::string name;
};

GigeCamera::GigeCamera(std::function<cv::Mat()>) {
  throw common::HardwareError(
      "this build has no GigE Vision camera; install libaravis-dev and configure again");
}
GigeCamera::~GigeCamera() = default;
const std::string& GigeCamera::name() const { return state_->name; }
const std::string& GigeCamera::serial() const { return state_->name; }

}  // namespace lodestone::emulation
