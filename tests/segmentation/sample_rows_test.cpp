#include "sample_rows.h"

#include <catch2/catch.hpp>
#include <opencv2/core.hpp>

#include <ATen/ATen.h>

using namespace lodestone;

TEST_CASE("images and masks lie in their rows, also where they are part of larger ones") {
  segmentation::SegmenterSamples samples{at::zeros({2, 3, 4, 4}, at::kByte),
                                         at::zeros({2, 2, 2, 2}, at::kByte)};
  cv::Mat whole(8, 8, CV_8UC3, cv::Scalar(1, 2, 3));
  whole.at<cv::Vec3b>(5, 6) = {9, 8, 7};
  segmentation::store_image(whole(cv::Rect(4, 4, 4, 4)), 1, samples);
  CHECK(samples.images[1][0][1][2].item<int>() == 9);
  CHECK(samples.images[1][2][0][0].item<int>() == 3);
  CHECK(samples.images[0].sum().item<int>() == 0);
  cv::Mat mask = cv::Mat::zeros(4, 4, CV_8U);
  mask(cv::Rect(2, 0, 2, 2)).setTo(200);
  segmentation::store_mask(mask, 0, 1, samples);
  CHECK(samples.masks[0][1][0][1].item<int>() == 200);
  CHECK(samples.masks.sum().item<int>() == 200);
}
