#include "lodestone/imaging/video_writer.h"

#include <sys/resource.h>

#include <catch2/catch.hpp>
#include <csignal>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "imaging/read_film.h"
#include "lodestone/common/error.h"
#include "temporary_folder.h"

using namespace lodestone;
using Catch::Matchers::Contains;

namespace {

constexpr int kFrames = 20;

/// Blue ground, a red block that walks to the right.
cv::Mat frame(int index, cv::Size size) {
  cv::Mat image(size, CV_8UC3, cv::Scalar(160, 40, 30));
  const int x = index * size.width / (kFrames + 4);
  cv::rectangle(image, {x, size.height / 4, size.width / 8, size.height / 2}, cv::Scalar(20, 30, 210),
                cv::FILLED);
  return image;
}

/// While it lives, files cannot grow beyond `bytes`: what a disk that fills up looks like to a writer.
class SmallFilesOnly {
 public:
  explicit SmallFilesOnly(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    REQUIRE(setrlimit(RLIMIT_FSIZE, &limit) == 0);
  }
  ~SmallFilesOnly() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  SmallFilesOnly(const SmallFilesOnly&) = delete;
  SmallFilesOnly& operator=(const SmallFilesOnly&) = delete;

 private:
  void (*handler_)(int);
  rlimit before_{};
};

}  // namespace

TEST_CASE("a video reads back with every frame, its size and what it showed") {
  const tests::TemporaryFolder folder;
  const std::string ending = GENERATE(as<std::string>{}, ".mp4", ".avi");
  const double scale = GENERATE(1.0, 0.5);
  const cv::Size size(320, 240);
  imaging::VideoWriter writer(folder / ("run" + ending), size, 25.0, scale);
  INFO(ending << " " << writer.codec() << " scale " << scale);
  for (int i = 0; i < kFrames; ++i) writer.write(frame(i, size));
  CHECK(writer.frames() == kFrames);
  writer.finish();
  CHECK_THROWS_AS(writer.write(frame(0, size)), common::LogicFault);
  if (ending == ".avi") CHECK(writer.codec() == "Motion JPEG");
  if (writer.codec() == "H.264") CHECK(writer.file() == folder / "run.mp4");

  const std::vector<cv::Mat> images = lodestone::tests::read_film(writer.file());
  REQUIRE(images.size() == kFrames);
  const cv::Size expected(static_cast<int>(320 * scale), static_cast<int>(240 * scale));
  CHECK(writer.size() == expected);
  for (int i = 0; i < kFrames; ++i) {
    REQUIRE(images[i].size() == expected);
    cv::Mat wanted;
    cv::resize(frame(i, size), wanted, expected, 0.0, 0.0, cv::INTER_AREA);
    CHECK(cv::norm(images[i], wanted, cv::NORM_L1) / (3.0 * wanted.total()) < 6.0);  // grey levels on average
  }
  // Frames are told apart: the first is nothing like the last.
  CHECK(cv::norm(images.front(), images.back(), cv::NORM_L1) / (3.0 * images[0].total()) > 10.0);
}

TEST_CASE("odd sizes are cut to even ones") {
  const tests::TemporaryFolder folder;
  imaging::VideoWriter writer(folder / "odd.mp4", {101, 75}, 10.0);
  writer.write(frame(0, {101, 75}));
  writer.finish();
  CHECK(writer.size() == cv::Size(100, 74));
  REQUIRE(lodestone::tests::read_film(writer.file()).size() == 1);
  CHECK(lodestone::tests::read_film(writer.file())[0].size() == cv::Size(100, 74));
}

TEST_CASE("a video that cannot be written is named") {
  const tests::TemporaryFolder folder;
  CHECK_THROWS_WITH(imaging::VideoWriter(folder / "a.mkv", {64, 48}, 10.0), Contains(".mp4 or .avi"));
  CHECK_THROWS_WITH(imaging::VideoWriter(folder / "no/a.mp4", {64, 48}, 10.0), Contains("no folder"));
  imaging::VideoWriter writer(folder / "a.avi", {64, 48}, 10.0);
  CHECK_THROWS_AS(writer.write(cv::Mat(48, 64, CV_8UC1)), common::LogicFault);
  CHECK_THROWS_AS(writer.write(cv::Mat(64, 48, CV_8UC3)), common::LogicFault);
}

TEST_CASE("a disk that fills up is an error, not a broken video") {
  const tests::TemporaryFolder folder;
  const std::string ending = GENERATE(as<std::string>{}, ".mp4", ".avi");
  const auto record = [&folder, &ending] {
    imaging::VideoWriter writer(folder / ("full" + ending), {320, 240}, 25.0);
    const SmallFilesOnly limit(100000);
    cv::Mat noise(240, 320, CV_8UC3);
    for (int i = 0; i < kFrames; ++i) {
      cv::randu(noise, 0, 255);
      writer.write(noise);
    }
    writer.finish();
  };
  CHECK_THROWS_AS(record(), common::IoError);
}
