#include <opencv2/core.hpp>

#include "fuzz.h"
#include "lodestone/imaging/frame_guard.h"
#include "lodestone/imaging/image_file.h"
#include "temporary_folder.h"

using namespace lodestone;

TEST_CASE("a spoiled image is decoded or refused by name", "[soak]") {
  const tests::Soak soak("spoiled images (PNG, JPEG, BMP, PGM)", 1000, 100'000);
  const tests::TemporaryFolder folder;
  cv::Mat image(24, 32, CV_8UC3);
  cv::theRNG().state = 7;
  cv::randu(image, 0, 255);
  std::vector<std::string> good;
  for (const char* extension : {".png", ".jpg", ".bmp", ".ppm"})
    good.push_back(imaging::encoded_image(image, extension));
  tests::Spoiler spoiler(soak.seed(), "images");
  const std::int64_t accepted = tests::fuzz(
      soak,
      [&] { tests::write_bytes(folder / "a", spoiler.bytes(spoiler.one_of(good), spoiler.one_of(good))); },
      [&] { imaging::read_image(folder / "a"); });
  CHECK(accepted > soak.count() / 100);
  CHECK(accepted < soak.count());
}
