#include "lodestone/inference/convolution.h"

#include <algorithm>
#include <utility>

#include "lodestone/common/error.h"

namespace lodestone::inference {
namespace {

/// [outputs, channels, side, side] with what the kernel covers in the order of its interleaved lines.
std::vector<float> by_column(const std::vector<float>& weight, std::int64_t outputs, std::int64_t side) {
  const std::int64_t covered = static_cast<std::int64_t>(weight.size()) / outputs;
  const std::int64_t channels = covered / (side * side);
  std::vector<float> ordered;
  ordered.reserve(weight.size());
  for (std::int64_t output = 0; output < outputs; ++output)
    for (std::int64_t x = 0; x < side; ++x)
      for (std::int64_t y = 0; y < side; ++y)
        for (std::int64_t channel = 0; channel < channels; ++channel)
          ordered.push_back(
              weight[static_cast<std::size_t>(output * covered + (channel * side + y) * side + x)]);
  return ordered;
}

/// Copies `count` pixels of `channels` numbers, which then lie `apart` numbers from each other.
void spread(const float* from, std::int64_t count, std::int64_t channels, float* to, std::int64_t apart) {
  for (std::int64_t x = 0; x < count; ++x, from += channels, to += apart)
    for (std::int64_t c = 0; c < channels; ++c) to[c] = from[c];
}

}  // namespace

float* FeatureMap::resize(std::int64_t height, std::int64_t width, std::int64_t channels) {
  height_ = height;
  width_ = width;
  channels_ = channels;
  return values_.at_least(height * width * channels);
}

Convolution::Convolution(const std::vector<float>& weight, std::vector<float> bias, std::int64_t side,
                         Stride stride, bool relu)
    : side_(side),
      channels_(static_cast<std::int64_t>(weight.size() / bias.size()) / (side * side)),
      stride_(stride),
      relu_(relu),
      bias_(std::move(bias)),
      weight_({by_column(weight, static_cast<std::int64_t>(bias_.size()), side).data(),
               side * side * channels_, static_cast<std::int64_t>(bias_.size()), /*transposed=*/true}) {
  LODESTONE_CHECK(channels_ > 0 && weight.size() == bias_.size() * static_cast<std::size_t>(weight_.k()),
                  "a square kernel for every channel and output");
}

/// Lines `first` to `first` + side of the image with its border: [width + 2 border, side, channels].
void Convolution::interleave(const FeatureMap& in, std::int64_t first, float* lines) const {
  const std::int64_t apart = side_ * channels_;
  const std::int64_t left = stride_.border * apart;
  std::fill_n(lines, left, 0.0F);
  std::fill_n(lines + left + in.width() * apart, left, 0.0F);
  for (std::int64_t line = 0; line < side_; ++line) {
    float* to = lines + left + line * channels_;
    const std::int64_t y = first + line;
    if (y >= 0 && y < in.height()) {
      spread(in.row(y), in.width(), channels_, to, apart);
    } else {
      for (std::int64_t x = 0; x < in.width(); ++x, to += apart) std::fill_n(to, channels_, 0.0F);
    }
  }
}

void Convolution::run(const FeatureMap& in, FeatureMap& out, CacheAligned<float>& lines) const {
  LODESTONE_CHECK(in.channels() == channels_, "an image with the channels of the weight");
  const auto places = [&](std::int64_t pixels) {
    return (pixels + 2 * stride_.border - side_) / stride_.step + 1;
  };
  const std::int64_t width = places(in.width());
  const std::int64_t height = places(in.height());
  const std::int64_t outputs = weight_.n();
  float* to = out.resize(height, width, outputs);
  float* covered = lines.at_least((in.width() + 2 * stride_.border) * side_ * channels_);
  for (std::int64_t y = 0; y < height; ++y, to += width * outputs) {
    interleave(in, y * stride_.step - stride_.border, covered);
    multiply<float>({covered, width, stride_.step * side_ * channels_}, weight_, to,
                    {bias_.data(), relu_, nullptr});
  }
}

void halve(const FeatureMap& in, FeatureMap& out) {
  const std::int64_t channels = in.channels();
  float* to = out.resize(in.height() / 2, in.width() / 2, channels);
  for (std::int64_t y = 0; y < out.height(); ++y) {
    const float* upper = in.row(2 * y);
    const float* lower = in.row(2 * y + 1);
    for (std::int64_t x = 0; x < out.width(); ++x, upper += 2 * channels, lower += 2 * channels)
      for (std::int64_t c = 0; c < channels; ++c)
        *to++ = std::max(std::max(upper[c], upper[c + channels]), std::max(lower[c], lower[c + channels]));
  }
}

void double_beside(const FeatureMap& across, const FeatureMap& in, FeatureMap& out) {
  LODESTONE_CHECK(across.height() == 2 * in.height() && across.width() == 2 * in.width(),
                  "maps of which one is twice as large");
  const std::int64_t channels = across.channels() + in.channels();
  float* to = out.resize(across.height(), across.width(), channels);
  for (std::int64_t y = 0; y < out.height(); ++y, to += out.width() * channels) {
    spread(across.row(y), out.width(), across.channels(), to, channels);
    for (std::int64_t parity = 0; parity < 2; ++parity)
      spread(in.row(y / 2), in.width(), in.channels(), to + parity * channels + across.channels(),
             2 * channels);
  }
}

}  // namespace lodestone::inference
