#include "palette.h"

#include <algorithm>
#include <array>

#include "lodestone/common/error.h"

namespace lodestone::imaging {
namespace {

constexpr int kBits = 5;
constexpr std::size_t kBins = std::size_t{1} << (3 * kBits);

std::size_t bin_of(const cv::Vec3b& colour) {
  std::size_t bin = 0;
  for (int channel = 0; channel < 3; ++channel) bin = bin << kBits | colour[channel] >> (8 - kBits);
  return bin;
}

/// The pixels of one bin.
struct Bin {
  std::size_t index = 0;
  std::int64_t pixels = 0;
  std::array<std::int64_t, 3> sum{};

  double mean(std::size_t channel) const {
    return static_cast<double>(sum[channel]) / static_cast<double>(pixels);
  }
};

/// Bins [first, last) that share one colour.
struct Box {
  std::vector<Bin>::iterator first;
  std::vector<Bin>::iterator last;
  std::size_t channel = 0;  ///< in which it is longest
  double gain = 0.0;        ///< its length there times the root of its pixels; 0 where it cannot be cut

  Box(std::vector<Bin>::iterator begin, std::vector<Bin>::iterator end) : first(begin), last(end) {
    if (last - first < 2) return;
    std::int64_t pixels = 0;
    for (auto bin = first; bin != last; ++bin) pixels += bin->pixels;
    for (std::size_t c = 0; c < 3; ++c) {
      const auto [low, high] =
          std::minmax_element(first, last, [c](const Bin& a, const Bin& b) { return a.mean(c) < b.mean(c); });
      const double length = (high->mean(c) - low->mean(c)) * std::sqrt(static_cast<double>(pixels));
      if (length <= gain) continue;
      gain = length;
      channel = c;
    }
  }

  /// Where half of its pixels lie on either side.
  std::vector<Bin>::iterator median() const {
    std::sort(first, last, [this](const Bin& a, const Bin& b) {
      return a.mean(channel) != b.mean(channel) ? a.mean(channel) < b.mean(channel) : a.index < b.index;
    });
    std::int64_t all = 0;
    for (auto bin = first; bin != last; ++bin) all += bin->pixels;
    std::int64_t below = first->pixels;
    auto cut = first + 1;
    while (cut + 1 != last && 2 * below < all) below += (cut++)->pixels;
    return cut;
  }

  cv::Vec3b colour() const {
    Bin all;
    for (auto bin = first; bin != last; ++bin) {
      all.pixels += bin->pixels;
      for (std::size_t c = 0; c < 3; ++c) all.sum[c] += bin->sum[c];
    }
    return {static_cast<std::uint8_t>(std::lround(all.mean(0))),
            static_cast<std::uint8_t>(std::lround(all.mean(1))),
            static_cast<std::uint8_t>(std::lround(all.mean(2)))};
  }
};

std::vector<Bin> histogram(const cv::Mat& image, const cv::Mat& mask) {
  std::vector<Bin> bins(kBins);
  for (int row = 0; row < image.rows; ++row) {
    const auto* pixels = image.ptr<cv::Vec3b>(row);
    const auto* wanted = mask.ptr<std::uint8_t>(row);
    for (int column = 0; column < image.cols; ++column) {
      if (wanted[column] == 0) continue;
      Bin& bin = bins[bin_of(pixels[column])];
      ++bin.pixels;
      for (int c = 0; c < 3; ++c) bin.sum[static_cast<std::size_t>(c)] += pixels[column][c];
    }
  }
  for (std::size_t i = 0; i < kBins; ++i) bins[i].index = i;
  bins.erase(std::remove_if(bins.begin(), bins.end(), [](const Bin& bin) { return bin.pixels == 0; }),
             bins.end());
  return bins;
}

}  // namespace

Palette::Palette(const cv::Mat& image, const cv::Mat& mask, int colours) : index_(kBins, 0) {
  LODESTONE_CHECK(image.type() == CV_8UC3 && mask.type() == CV_8UC1 && image.size() == mask.size(),
                  "an image and its mask must be 8-bit BGR and 8-bit of the same size");
  LODESTONE_CHECK(colours >= 1 && colours <= 256, std::to_string(colours) + " colours, must be 1 to 256");
  std::vector<Bin> bins = histogram(image, mask);
  if (bins.empty()) return;
  std::vector<Box> boxes = {Box(bins.begin(), bins.end())};
  while (static_cast<int>(boxes.size()) < colours) {
    const auto longest = std::max_element(boxes.begin(), boxes.end(),
                                          [](const Box& a, const Box& b) { return a.gain < b.gain; });
    if (longest->gain == 0.0) break;
    const auto cut = longest->median();
    const Box upper(cut, longest->last);
    *longest = Box(longest->first, cut);
    boxes.push_back(upper);
  }
  for (const Box& box : boxes) {
    for (auto bin = box.first; bin != box.last; ++bin)
      index_[bin->index] = static_cast<std::uint8_t>(colours_.size());
    colours_.push_back(box.colour());
  }
}

std::uint8_t Palette::index_of(const cv::Vec3b& colour) const { return index_[bin_of(colour)]; }

}  // namespace lodestone::imaging
