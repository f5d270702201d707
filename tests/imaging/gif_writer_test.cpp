#include "lodestone/imaging/gif_writer.h"

#include <catch2/catch.hpp>
#include <filesystem>
#include <opencv2/imgproc.hpp>

#include "imaging/read_film.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "temporary_folder.h"

using lodestone::imaging::GifWriter;

namespace {

/// A noisy ground with a bright square that moves with `step`; enough colours and codes to fill the
/// dictionary.
cv::Mat scene(int step) {
  cv::Mat image(120, 160, CV_8UC3);
  cv::RNG random(static_cast<std::uint64_t>(step) + 1);
  for (int row = 0; row < image.rows; ++row)
    for (int column = 0; column < image.cols; ++column)
      for (int channel = 0; channel < 3; ++channel)
        image.at<cv::Vec3b>(row, column)[channel] =
            static_cast<std::uint8_t>(40 + row / (channel + 1) + column / 2 + random.uniform(0, 3));
  cv::rectangle(image, cv::Rect(10 + 12 * step, 40, 16, 16), cv::Scalar(20, 40, 230), cv::FILLED);
  return image;
}

}  // namespace

TEST_CASE("another program sees what was written, frame by frame") {
  const lodestone::tests::TemporaryFolder folder;
  constexpr int kFrames = 8;
  GifWriter writer(folder / "a.gif", {160, 120}, 10.0);
  for (int step = 0; step < kFrames; ++step) writer.write(scene(step));
  CHECK(writer.frames() == kFrames);
  writer.finish(0.1);

  const std::vector<cv::Mat> frames = lodestone::tests::read_film(folder / "a.gif");
  REQUIRE(frames.size() >= kFrames);
  for (int step = 0; step < kFrames; ++step) {
    cv::Mat difference;
    cv::absdiff(frames[static_cast<std::size_t>(step)], scene(step), difference);
    CAPTURE(step);
    CHECK(cv::mean(difference.reshape(1))[0] < 6.0);
    // The square is where it belongs, and gone from where it was.
    const cv::Vec3b inside = frames[static_cast<std::size_t>(step)].at<cv::Vec3b>(48, 18 + 12 * step);
    CHECK(inside[2] > 200);
    CHECK(inside[0] < 60);
  }
  CHECK(cv::norm(frames.back(), frames[kFrames - 1], cv::NORM_INF) == 0.0);
}

TEST_CASE("what does not change costs little") {
  const lodestone::tests::TemporaryFolder folder;
  const auto bytes_of = [&](int frames) {
    GifWriter writer(folder / "b.gif", {160, 120}, 10.0);
    for (int i = 0; i < frames; ++i) writer.write(scene(0));
    writer.finish();
    return std::filesystem::file_size(folder / "b.gif");
  };
  const auto one = bytes_of(1);
  CHECK(one > 10000);
  CHECK((bytes_of(11) - one) / 10 < 1000);
}

TEST_CASE("a single pixel of one colour can be written") {
  const lodestone::tests::TemporaryFolder folder;
  GifWriter writer(folder / "c.gif", {1, 1}, 50.0);
  writer.write(cv::Mat(1, 1, CV_8UC3, cv::Scalar(1, 2, 3)));
  writer.finish();
  const std::string bytes = lodestone::common::read_file(folder / "c.gif");
  CHECK(bytes.rfind("GIF89a", 0) == 0);
  CHECK(bytes.back() == ';');
}

TEST_CASE("frames of another size and a folder that is not there are refused") {
  const lodestone::tests::TemporaryFolder folder;
  GifWriter writer(folder / "d.gif", {160, 120}, 10.0);
  CHECK_THROWS_AS(writer.write(cv::Mat(10, 10, CV_8UC3)), lodestone::common::LogicFault);
  CHECK_THROWS_AS(GifWriter(folder / "nowhere/d.gif", {160, 120}, 10.0), lodestone::common::IoError);
  writer.finish();
  CHECK_THROWS_AS(writer.write(scene(0)), lodestone::common::LogicFault);
}
