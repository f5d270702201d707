#include "lodestone/rig/file_camera.h"

#include <catch2/catch.hpp>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "camera_conformance.h"
#include "lodestone/common/files.h"
#include "lodestone/rig/camera_source.h"
#include "temporary_folder.h"

using namespace lodestone;
using Catch::Matchers::Contains;

namespace {

cv::Mat flat(int grey, int type = CV_8UC3) { return cv::Mat(48, 64, type, cv::Scalar::all(grey)); }

int grey_of(const imaging::Frame& frame) { return frame.image.at<cv::Vec3b>(24, 32)[1]; }

void write_video(const std::string& file, int frames) {
  cv::VideoWriter writer(file, cv::CAP_OPENCV_MJPEG, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 30.0,
                         {64, 48});
  REQUIRE(writer.isOpened());
  for (int i = 0; i < frames; ++i) writer.write(flat(40 * (i + 1)));
}

}  // namespace

TEST_CASE("a folder of images is a camera that shows them by name and then ends") {
  const tests::TemporaryFolder folder;
  for (const int i : {2, 0, 1}) cv::imwrite(folder / ("frame_" + std::to_string(i) + ".png"), flat(50 * i));
  common::write_file_atomically(folder / "notes.txt", "not an image");
  rig::FileCamera camera(folder.path(), 20.0);
  for (int i = 0; i < 3; ++i) {
    const imaging::Frame frame = camera.grab(0.0);
    CHECK(grey_of(frame) == 50 * i);
    CHECK(frame.stamp_s == Approx(0.05 * i));
  }
  CHECK_THROWS_WITH(camera.grab(1.0), Contains("has no more images after 3"));
}

TEST_CASE("folders, patterns and videos keep the contract of Camera") {
  const tests::TemporaryFolder folder;
  for (int i = 0; i < 2; ++i) cv::imwrite(folder / ("frame_" + std::to_string(i) + ".png"), flat(50 * i));
  write_video(folder / "film.avi", 2);
  for (const std::string& source : {folder.path(), folder / "frame_*.png", folder / "film.avi"}) {
    rig::CameraSourceConfig config;
    config.source = source;
    const auto camera = rig::open_camera(config);
    tests::check_camera(*camera);
    tests::check_silent_camera(*camera);  // two images, no third
  }
}

TEST_CASE("a video is read to its end, a single image once") {
  const tests::TemporaryFolder folder;
  write_video(folder / "film.avi", 5);
  rig::FileCamera film(folder / "film.avi", 30.0);
  for (int i = 0; i < 5; ++i) CHECK(grey_of(film.grab(0.0)) == Approx(40 * (i + 1)).margin(4));
  CHECK_THROWS_WITH(film.grab(0.0), Contains("after 5"));

  cv::imwrite(folder / "one.png", flat(77));
  rig::FileCamera one(folder / "one.png", 30.0);
  CHECK(grey_of(one.grab(0.0)) == 77);
  CHECK_THROWS_AS(one.grab(0.0), common::HardwareError);
}

TEST_CASE("a grey image stays grey, so that the frame guard can refuse it") {
  const tests::TemporaryFolder folder;
  cv::imwrite(folder / "a.png", flat(10, CV_8UC1));
  cv::imwrite(folder / "b.png", flat(10, CV_8UC4));
  rig::FileCamera camera(folder.path(), 30.0);
  CHECK(camera.grab(0.0).image.type() == CV_8UC1);
  CHECK(camera.grab(0.0).image.type() == CV_8UC3);
}

TEST_CASE("what cannot be read from disk is named") {
  const tests::TemporaryFolder folder;
  CHECK_THROWS_WITH(rig::FileCamera(folder / "nowhere", 30.0), Contains("nowhere"));
  CHECK_THROWS_AS(rig::FileCamera("", 30.0), common::IoError);
  CHECK_THROWS_WITH(rig::FileCamera(folder.path(), 30.0), Contains("no images in folder"));
  CHECK_THROWS_WITH(rig::FileCamera(folder / "*.png", 30.0), Contains("no file matches"));
  common::write_file_atomically(folder / "text.mp4", "this is no video at all");
  CHECK_THROWS_WITH(rig::FileCamera(folder / "text.mp4", 30.0), Contains("as a video"));

  cv::imwrite(folder / "cut.png", flat(10));
  common::write_file_atomically(folder / "cut.png", common::read_file(folder / "cut.png").substr(0, 30));
  common::write_file_atomically(folder / "empty.png", "");
  rig::FileCamera camera(folder.path(), 30.0);
  CHECK_THROWS_WITH(camera.grab(0.0), Contains("cut.png"));
  CHECK_THROWS_WITH(rig::FileCamera(folder / "empty.png", 30.0).grab(0.0), Contains("empty.png"));
  CHECK_THROWS_AS(rig::FileCamera(folder / "cut.png", 0.0), common::ConfigError);
}
