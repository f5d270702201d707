#include "lodestone/rig/aravis_camera.h"

#include <arv.h>

#include <atomic>
#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "camera_conformance.h"
#include "lodestone/common/clock.h"

using namespace lodestone;
using Catch::Matchers::Contains;

namespace {

// Colours of the four quarters, as red, green, blue: top left, top right, bottom left, bottom right.
constexpr int kQuarters[4][3] = {{220, 30, 40}, {20, 200, 60}, {50, 70, 230}, {180, 180, 20}};

int grey(const int* rgb) { return (rgb[0] + rgb[1] + rgb[2]) / 3; }

/// What a sensor with this colour filter reads at a pixel; `pattern` is the filter's first row, then second.
int filtered(const char* pattern, int row, int column, const int* rgb) {
  const char filter = pattern[2 * (row % 2) + column % 2];
  return rgb[filter == 'R' ? 0 : filter == 'G' ? 1 : 2];
}

void paint(ArvBuffer* buffer, void* frames, guint32, guint32, ArvPixelFormat format) {
  std::size_t bytes = 0;
  auto* const out = static_cast<unsigned char*>(const_cast<void*>(arv_buffer_get_data(buffer, &bytes)));
  const int width = arv_buffer_get_image_width(buffer);
  const int height = arv_buffer_get_image_height(buffer);
  const char* pattern = format == ARV_PIXEL_FORMAT_BAYER_RG_8   ? "RGGB"
                        : format == ARV_PIXEL_FORMAT_BAYER_GB_8 ? "GBRG"
                        : format == ARV_PIXEL_FORMAT_BAYER_GR_8 ? "GRBG"
                        : format == ARV_PIXEL_FORMAT_BAYER_BG_8 ? "BGGR"
                                                                : nullptr;
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      const int* const rgb = kQuarters[2 * (2 * row >= height) + (2 * column >= width)];
      const std::size_t at = static_cast<std::size_t>(row) * width + column;
      if (format == ARV_PIXEL_FORMAT_RGB_8_PACKED) {
        for (int channel = 0; channel < 3; ++channel) out[3 * at + channel] = rgb[channel];
      } else {
        out[at] = pattern != nullptr ? filtered(pattern, row, column, rgb) : grey(rgb);
      }
    }
  }
  ++*static_cast<std::atomic<int>*>(frames);
}

/// Aravis' own GigE Vision camera on the loopback, showing four coloured quarters.
class FakeGigeCamera {
 public:
  FakeGigeCamera() : camera_(arv_gv_fake_camera_new("127.0.0.1", "LODESTONE")) {
    if (arv_gv_fake_camera_is_running(camera_) == 0)
      throw common::HardwareError(
          "the fake GigE Vision camera does not start: is its port (UDP 3956) in use?");
    arv_fake_camera_set_fill_pattern(arv_gv_fake_camera_get_fake_camera(camera_), paint, &frames);
  }
  ~FakeGigeCamera() { fall_silent(); }
  FakeGigeCamera(const FakeGigeCamera&) = delete;
  FakeGigeCamera& operator=(const FakeGigeCamera&) = delete;

  void fall_silent() { g_clear_object(&camera_); }

  std::atomic<int> frames{0};

 private:
  ArvGvFakeCamera* camera_;
};

rig::CameraSourceConfig fake_source() {
  rig::CameraSourceConfig config;
  config.kind = rig::CameraKind::kGenicam;
  config.source = "Aravis-Fake-LODESTONE";
  config.width_px = 320;
  config.height_px = 240;
  config.frame_rate_hz = 20.0;
  return config;
}

}  // namespace

TEST_CASE("a GenICam camera over GigE Vision keeps the contract of Camera, and says when it is lost",
          "[slow]") {
  FakeGigeCamera fake;
  const auto camera = rig::open_camera(fake_source());
  tests::check_camera(*camera);

  const common::SteadyClock clock;
  const imaging::Frame frame = camera->grab(2.0);
  CHECK(frame.image.size() == cv::Size(320, 240));
  CHECK(frame.stamp_s < clock.now_s());
  CHECK(frame.stamp_s > clock.now_s() - 1.0);

  fake.fall_silent();
  // What was on its way may still come; then it must be an error, every time.
  bool silent = false;
  for (int i = 0; i < 20 && !silent; ++i) {
    try {
      camera->grab(0.3);
    } catch (const common::HardwareError& error) {
      silent = true;
      CHECK_THAT(error.what(), Contains("no image within 0.3 s") || Contains("was lost"));
    }
  }
  CHECK(silent);
  tests::check_silent_camera(*camera);
}

TEST_CASE("a GigE camera that another program has open says so, and is free again when that one closes it",
          "[slow]") {
  FakeGigeCamera fake;
  auto first = rig::open_camera(fake_source());
  CHECK_THROWS_WITH(rig::open_camera(fake_source()), Contains("another program has it open"));
  CHECK_FALSE(first->grab(2.0).image.empty());
  first.reset();
  CHECK_FALSE(rig::open_camera(fake_source())->grab(2.0).image.empty());
}

TEST_CASE("colours of a GenICam camera arrive as BGR in every pixel format it offers", "[slow]") {
  FakeGigeCamera fake;
  rig::CameraSourceConfig config = fake_source();
  for (const std::string format : {"", "BayerRG8", "BayerGB8", "BayerGR8", "BayerBG8", "RGB8", "Mono8"}) {
    INFO("format '" << format << "'");
    config.pixel_format = format;
    rig::AravisCamera camera(config);
    camera.grab(2.0);  // the first may be of the format before
    const cv::Mat image = camera.grab(2.0).image;
    REQUIRE(image.type() == CV_8UC3);
    for (int quarter = 0; quarter < 4; ++quarter) {
      const cv::Vec3b pixel = image.at<cv::Vec3b>(60 + 120 * (quarter / 2), 80 + 160 * (quarter % 2));
      const int* const rgb = kQuarters[quarter];
      for (int channel = 0; channel < 3; ++channel) {
        CHECK(int(pixel[2 - channel]) == (format == "Mono8" ? grey(rgb) : rgb[channel]));
      }
    }
  }
}

TEST_CASE("most frames of full size arrive over the loopback, and a late caller sees the present", "[slow]") {
  FakeGigeCamera fake;
  rig::CameraSourceConfig config = fake_source();
  config.width_px = 1280;
  config.height_px = 1024;
  rig::AravisCamera camera(config);
  camera.grab(2.0);
  const int before = fake.frames;
  for (int i = 0; i < 40; ++i) camera.grab(2.0);
  CHECK(fake.frames - before <= 50);  // 40 were received

  common::SteadyClock clock;
  clock.sleep_until(clock.now_s() + 1.0);  // 20 frames: more than there are buffers
  const double asked_s = clock.now_s();
  CHECK(camera.grab(2.0).stamp_s > asked_s - 0.2);
}

TEST_CASE("what a GenICam camera cannot do is named with its bound", "[slow]") {
  rig::CameraSourceConfig config = fake_source();
  config.source = "Aravis-Fake-NOBODY";
  CHECK_THROWS_WITH(rig::open_camera(config), Contains("Aravis-Fake-NOBODY") && Contains("arv-tool"));
  FakeGigeCamera fake;
  config = fake_source();
  config.width_px = 5000;
  CHECK_THROWS_WITH(rig::open_camera(config), Contains("width_px = 5000") && Contains("2048"));
  config = fake_source();
  config.pixel_format = "Mono16";
  CHECK_THROWS_WITH(rig::open_camera(config), Contains("Mono16") && Contains("BayerRG8"));
  config = fake_source();
  config.exposure_s = 1e-9;
  CHECK_THROWS_WITH(rig::open_camera(config), Contains("exposure_s"));
}

TEST_CASE("a camera with another serial number than the one asked for is refused") {
  const FakeGigeCamera fake;
  rig::CameraSourceConfig config = fake_source();
  config.serial = "LODESTONE";
  CHECK_NOTHROW(rig::AravisCamera(config));
  config.serial = "OTHER-7";
  CHECK_THROWS_WITH(rig::AravisCamera(config), Contains("LODESTONE") && Contains("OTHER-7"));
}
