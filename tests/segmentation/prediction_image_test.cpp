#include "prediction_image.h"

#include <catch2/catch.hpp>

#include <ATen/ATen.h>

using namespace lodestone;

TEST_CASE("a sheet has a row an image: it, its true mask and the predicted one, needle red and tape green") {
  const at::Tensor images = at::full({2, 3, 8, 8}, 7, at::kByte);
  at::Tensor masks = at::zeros({2, 2, 4, 4}, at::kByte);
  masks.select(1, 0).fill_(255);  // all needle
  at::Tensor probability = at::zeros({2, 2, 4, 4});
  probability[1][1].fill_(1.0);  // the second is taken for tape
  const cv::Mat sheet = segmentation::prediction_image(images, masks, probability);
  REQUIRE(sheet.rows == 16);
  REQUIRE(sheet.cols == 24);
  CHECK(sheet.at<cv::Vec3b>(3, 3) == cv::Vec3b(7, 7, 7));
  CHECK(sheet.at<cv::Vec3b>(3, 11) == cv::Vec3b(0, 0, 255));
  CHECK(sheet.at<cv::Vec3b>(3, 19) == cv::Vec3b(0, 0, 0));
  CHECK(sheet.at<cv::Vec3b>(12, 19) == cv::Vec3b(0, 255, 0));
}
