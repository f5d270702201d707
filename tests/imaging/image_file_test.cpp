#include "lodestone/imaging/image_file.h"

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <opencv2/core.hpp>

#include "lodestone/common/error.h"
#include "temporary_folder.h"

using namespace lodestone;

TEST_CASE("an image comes back from its file, and one that cannot be written is an error") {
  const tests::TemporaryFolder folder;
  cv::Mat image(8, 6, CV_8UC3);
  cv::randu(image, 0, 255);
  imaging::write_image(folder / "a.png", image);
  CHECK(cv::norm(imaging::read_image(folder / "a.png"), image, cv::NORM_INF) == 0.0);
  CHECK_THROWS_AS(imaging::write_image(folder / "no/such/folder.png", image), common::IoError);
  CHECK_THROWS_AS(imaging::write_image(folder / "a.nothing", image), common::IoError);
  CHECK_THROWS_AS(imaging::write_image(folder / "empty.png", cv::Mat()), common::IoError);
  CHECK_FALSE(std::filesystem::exists(folder / "empty.png"));
}

TEST_CASE("what is no image is an error with its name") {
  const tests::TemporaryFolder folder;
  std::ofstream(folder / "text.png") << "hello";
  CHECK_THROWS_WITH(imaging::read_image(folder / "text.png"), Catch::Contains("text.png"));
  std::ofstream(folder / "empty.png");
  CHECK_THROWS_AS(imaging::read_image(folder / "empty.png"), common::IoError);
  CHECK_THROWS_AS(imaging::read_image("/dev/zero"), common::IoError);
}
