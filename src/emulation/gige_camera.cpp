#include "gige_camera.h"

#include <arv.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>

#include "lodestone/common/error.h"
#include "lodestone/common/realtime.h"

namespace lodestone::emulation {

struct GigeCamera::State {
  std::function<cv::Mat()> image;
  cv::Mat shown;
  // Its own, so that a program that is to drive another bench does not take this one's images.
  std::string serial = "LODE-" + std::to_string(getpid());
  std::string name = "Aravis-Fake-" + serial;
  ArvGvFakeCamera* camera = nullptr;

  static void paint(ArvBuffer* buffer, void* self, guint32, guint32, ArvPixelFormat format) {
    thread_local const common::RealtimeThread realtime;  // as LiveBench
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

namespace {

/// Aravis lets any number of cameras share the address, and answers for whichever came first.
bool address_is_free() {
  const int probe = socket(AF_INET, SOCK_DGRAM, 0);
  if (probe < 0) return false;
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(3956);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const bool free = bind(probe, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  close(probe);
  return free;
}

}  // namespace

GigeCamera::GigeCamera(std::function<cv::Mat()> image) : state_(std::make_unique<State>()) {
  state_->image = std::move(image);
  if (address_is_free()) state_->camera = arv_gv_fake_camera_new("127.0.0.1", state_->serial.c_str());
  if (state_->camera == nullptr || arv_gv_fake_camera_is_running(state_->camera) == 0) {
    g_clear_object(&state_->camera);
    throw common::HardwareError(
        "the emulated camera does not start: its port (127.0.0.1, UDP 3956) is in use, probably by another "
        "emulated bench; end that one, or emulate this one with --no-camera");
  }
  arv_fake_camera_set_fill_pattern(arv_gv_fake_camera_get_fake_camera(state_->camera), State::paint,
                                   state_.get());
}

GigeCamera::~GigeCamera() { g_clear_object(&state_->camera); }

const std::string& GigeCamera::name() const { return state_->name; }
const std::string& GigeCamera::serial() const { return state_->serial; }

}  // namespace lodestone::emulation
