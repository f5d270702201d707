#include "gige_camera.h"

#include <arv.h>

#include <algorithm>
#include <cstring>

#include "lodestone/common/error.h"

namespace lodestone::emulation {

struct GigeCamera::State {
  std::function<cv::Mat()> image;
  cv::Mat shown;
  std::string name = "Aravis-Fake-LODESTONE";
  ArvGvFakeCamera* camera = nullptr;

  static void paint(ArvBuffer* buffer, void* self, guint32, guint32, ArvPixelFormat format) {
    auto& state = *static_cast<State*>(self);
    const cv::Mat fresh = state.image();
    if (!fresh.empty()) state.shown = fresh;
    std::size_t bytes = 0;
    auto* const out = static_cast<unsigned char*>(const_cast<void*>(arv_buffer_get_data(buffer, &bytes)));
    const int width = std::min(arv_buffer_get_image_width(buffer), state.shown.cols);
    const int height = std::min(arv_buffer_get_image_height(buffer), state.shown.rows);
    const auto stride = static_cast<std::size_t>(arv_buffer_get_image_width(buffer));
    if (format != ARV_PIXEL_FORMAT_RGB_8_PACKED) return;  // black tells that it was asked for another one
    for (int row = 0; row < height; ++row) {
      const cv::Vec3b* from = state.shown.ptr<cv::Vec3b>(row);
      unsigned char* to = out + 3 * stride * static_cast<std::size_t>(row);
      for (int column = 0; column < width; ++column, to += 3) {
        to[0] = from[column][2];
        to[1] = from[column][1];
        to[2] = from[column][0];
      }
    }
  }
};

GigeCamera::GigeCamera(std::function<cv::Mat()> image) : state_(std::make_unique<State>()) {
  state_->image = std::move(image);
  state_->camera = arv_gv_fake_camera_new("127.0.0.1", "LODESTONE");
  if (arv_gv_fake_camera_is_running(state_->camera) == 0) {
    g_clear_object(&state_->camera);
    throw common::HardwareError(
        "the emulated camera does not start: is its port (UDP 3956) in use by another one?");
  }
  arv_fake_camera_set_fill_pattern(arv_gv_fake_camera_get_fake_camera(state_->camera), State::paint,
                                   state_.get());
}

GigeCamera::~GigeCamera() { g_clear_object(&state_->camera); }

const std::string& GigeCamera::name() const { return state_->name; }

}  // namespace lodestone::emulation
