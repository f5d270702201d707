#include "lodestone/inference/unet.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/common/error.h"
#include "unet_weights.h"

using namespace lodestone;
using inference::UNet;

// That it is the function that was trained: tests/nets/unet_test.cpp.

namespace {

std::vector<std::uint8_t> drawn_image(std::int64_t height, std::int64_t width) {
  common::RandomStream random(2, "image");
  std::vector<std::uint8_t> image(static_cast<std::size_t>(3 * height * width));
  for (std::uint8_t& value : image) value = static_cast<std::uint8_t>(random.below(256));
  return image;
}

std::vector<float> logits_of(const UNet& network, std::int64_t height, std::int64_t width,
                             UNet::Workspace& workspace) {
  const inference::UNetConfig& config = network.config();
  std::vector<float> logits(static_cast<std::size_t>(inference::UNetConfig::kClasses * height * width *
                                                     config.upscale * config.upscale /
                                                     (config.stem * config.stem)));
  network.forward(drawn_image(height, width).data(), height, width, logits.data(), workspace);
  return logits;
}

}  // namespace

TEST_CASE("a mask does not depend on what the workspace held before", "[unit]") {
  const UNet network(tests::small_unet(), tests::drawn_unet_weights(tests::small_unet(), 1), "it");
  UNet::Workspace used;
  const std::vector<float> first = logits_of(network, 64, 96, used);
  logits_of(network, 128, 128, used);
  logits_of(network, 16, 16, used);
  CHECK(logits_of(network, 64, 96, used) == first);
  UNet::Workspace fresh;
  CHECK(logits_of(network, 64, 96, fresh) == first);
}

TEST_CASE("masks are the same with the kernels of AVX2 and AVX-512", "[unit]") {
  const std::vector<std::string> kernels = inference::gemm_kernels();
  std::vector<std::vector<float>> masks;
  for (const std::string& name : kernels) {
    if (name == "generic") continue;  // without fused products it rounds more often
    inference::select_gemm_kernels(name);
    const UNet network(tests::small_unet(), tests::drawn_unet_weights(tests::small_unet(), 1), "it");
    UNet::Workspace workspace;
    masks.push_back(logits_of(network, 64, 64, workspace));
  }
  inference::select_gemm_kernels(kernels.front());
  for (const std::vector<float>& mask : masks) CHECK(mask == masks.front());
}

TEST_CASE("a needle's mask moves with it by whole squares of the coarsest level, away from the border",
          "[unit]") {
  const UNet network(tests::small_unet(), tests::drawn_unet_weights(tests::small_unet(), 3), "it");
  UNet::Workspace workspace;
  constexpr std::int64_t kSide = 320, kMask = kSide / 2;
  constexpr std::int64_t kReach = 50;  // mask pixels from the border: no place there sees it
  const auto mask_of = [&](std::int64_t first) {
    std::vector<std::uint8_t> image(3 * kSide * kSide, 120);
    for (std::int64_t y = 150; y < 170; ++y)
      std::fill_n(image.begin() + 3 * (y * kSide + first), 15, std::uint8_t{20});
    std::vector<float> logits(2 * kMask * kMask);
    network.forward(image.data(), kSide, kSide, logits.data(), workspace);
    return logits;
  };
  const std::int64_t multiple = network.config().multiple();
  const std::vector<float> left = mask_of(140), right = mask_of(140 + multiple);
  double seen = 0.0;
  for (std::int64_t y = kReach; y < kMask - kReach; ++y)
    for (std::int64_t x = kReach; x < kMask - kReach - multiple / 2; ++x) {
      const auto place = static_cast<std::size_t>(y * kMask + x);
      CHECK(right[place + static_cast<std::size_t>(multiple / 2)] == left[place]);
      seen = std::max(seen, static_cast<double>(std::abs(left[place] - left[kReach * kMask + kReach])));
    }
  CHECK(seen > 0.01);
}

TEST_CASE("weights that do not fit, and numbers that cannot be, are named", "[unit]") {
  const inference::UNetConfig config = tests::small_unet();
  const auto fault_of = [&](const std::string& name, const inference::Array& array,
                            const inference::UNetConfig& shape) {
    inference::Arrays weights = tests::drawn_unet_weights(config, 1);
    if (!name.empty()) weights[name] = array;
    try {
      UNet(shape, weights, "it");
    } catch (const common::CheckpointError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  CHECK(fault_of("", {}, config) == "accepted");
  // It would take 10 GB, none of which is asked for.
  CHECK_THAT(fault_of("", {}, {256, 6, 4, 2}),
             Catch::Contains("stem.weight") && Catch::Contains("expected [256, 3, 6, 6]"));
  CHECK_THAT(fault_of("colour_std", {std::vector<float>{1, 0, 1}, {1, 3, 1, 1}}, config),
             Catch::Contains("colour_std"));
  CHECK_THAT(fault_of("head.bias", {std::vector<float>(8, NAN), {8}}, config),
             Catch::Contains("head.bias") && Catch::Contains("finite"));
  CHECK_THAT(fault_of("stem_norm.running_var", {std::vector<float>(4, -1.0F), {4}}, config),
             Catch::Contains("stem_norm.running_var") && Catch::Contains("no variance"));
  const UNet network(config, tests::drawn_unet_weights(config, 1), "it");
  UNet::Workspace workspace;
  std::vector<float> logits(8);
  CHECK_THROWS_AS(network.forward(drawn_image(8, 8).data(), 8, 8, logits.data(), workspace),
                  common::LogicFault);
}
