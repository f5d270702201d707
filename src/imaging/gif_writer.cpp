#include "lodestone/imaging/gif_writer.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <unordered_map>
#include <vector>

#include "lodestone/common/error.h"
#include "palette.h"

namespace lodestone::imaging {
namespace {

constexpr int kCodeBits = 8;
constexpr int kTransparent = 255;
constexpr int kVisible = 14;    // levels of a channel; below lies the camera's noise
constexpr int kLeastDelay = 2;  // browsers slow shorter ones down

void put16(std::string& bytes, int value) {
  bytes += static_cast<char>(value & 255);
  bytes += static_cast<char>(value >> 8 & 255);
}

/// Codes of growing width, packed from the lowest bit on, in blocks of up to 255 bytes.
class CodeStream {
 public:
  void put(int code, int bits) {
    pending_ |= static_cast<std::uint32_t>(code) << held_;
    for (held_ += bits; held_ >= 8; held_ -= 8, pending_ >>= 8U) bytes_ += static_cast<char>(pending_ & 255U);
  }
  std::string blocks() {
    if (held_ > 0) bytes_ += static_cast<char>(pending_ & 255U);
    std::string packed;
    for (std::size_t at = 0; at < bytes_.size(); at += 255) {
      const std::string block = bytes_.substr(at, 255);
      packed += static_cast<char>(block.size());
      packed += block;
    }
    return packed + '\0';
  }

 private:
  std::string bytes_;
  std::uint32_t pending_ = 0;
  int held_ = 0;
};

/// Lempel, Ziv and Welch's compression as GIF89a (appendix F) has it: the dictionary starts over when it
/// holds 4096 strings.
std::string compressed(const std::vector<std::uint8_t>& pixels) {
  constexpr int kClear = 1 << kCodeBits;
  constexpr int kEnd = kClear + 1;
  constexpr int kMostCodes = 4096;
  CodeStream stream;
  std::unordered_map<int, int> longer;  // string's code and next pixel: code of both
  int next = kEnd + 1;
  int bits = kCodeBits + 1;
  stream.put(kClear, bits);
  int prefix = pixels.front();
  for (std::size_t i = 1; i < pixels.size(); ++i) {
    const int both = prefix << kCodeBits | pixels[i];
    const auto known = longer.find(both);
    if (known != longer.end()) {
      prefix = known->second;
      continue;
    }
    stream.put(prefix, bits);
    if (next < kMostCodes) {
      // The reader is one string behind: the width grows when this one no longer fits.
      if (next == 1 << bits) ++bits;
      longer.emplace(both, next++);
    } else {
      stream.put(kClear, bits);
      longer.clear();
      next = kEnd + 1;
      bits = kCodeBits + 1;
    }
    prefix = pixels[i];
  }
  stream.put(prefix, bits);
  if (next == 1 << bits && bits < 12) ++bits;
  stream.put(kEnd, bits);
  return stream.blocks();
}

}  // namespace

GifWriter::GifWriter(const std::string& file, cv::Size size, double frame_rate_hz)
    : file_(file), out_(file, std::ios::binary | std::ios::trunc), size_(size) {
  LODESTONE_CHECK(size.width >= 1 && size.height >= 1 && size.width <= 65535 && size.height <= 65535,
                  "a GIF's sides must be 1 to 65535 pixels");
  LODESTONE_CHECK(frame_rate_hz > 0.0, "frame rate " + std::to_string(frame_rate_hz) + " must be positive");
  delay_cs_ = std::clamp(static_cast<int>(std::lround(100.0 / frame_rate_hz)), kLeastDelay, 65535);
  std::string head = "GIF89a";
  put16(head, size.width);
  put16(head, size.height);
  head += std::string("\x70\0\0", 3);  // no palette for all frames
  // Starts over without end.
  head += std::string("\x21\xFF\x0BNETSCAPE2.0\x03\x01\0\0\0", 19);
  out_ << head;
  check();
}

void GifWriter::check() const {
  if (!out_)
    throw common::IoError("cannot write the animation " + file_ +
                          ": check the folder and the space on the disk");
}

void GifWriter::put_frame(const cv::Mat& image, const cv::Mat& changed, int delay_cs) {
  cv::Rect box = cv::boundingRect(changed);
  if (box.empty()) box = cv::Rect(0, 0, 1, 1);
  const cv::Mat part = image(box);
  const cv::Mat mask = changed(box);
  const Palette palette(part, mask, kTransparent);

  std::string head("\x21\xF9\x04\x05", 4);  // what is drawn stays; one colour is transparent
  put16(head, delay_cs);
  head += static_cast<char>(kTransparent);
  head += std::string("\0\x2C", 2);
  for (const int value : {box.x, box.y, box.width, box.height}) put16(head, value);
  head += '\x87';  // 256 colours of its own
  for (std::size_t i = 0; i < 256; ++i)
    for (int channel = 2; channel >= 0; --channel)
      head += i < palette.colours().size() ? static_cast<char>(palette.colours()[i][channel]) : '\0';
  head += static_cast<char>(kCodeBits);

  std::vector<std::uint8_t> pixels;
  pixels.reserve(static_cast<std::size_t>(box.area()));
  cv::Mat shown = shown_(box);
  for (int row = 0; row < box.height; ++row)
    for (int column = 0; column < box.width; ++column) {
      if (mask.at<std::uint8_t>(row, column) == 0) {
        pixels.push_back(kTransparent);
        continue;
      }
      pixels.push_back(palette.index_of(part.at<cv::Vec3b>(row, column)));
      shown.at<cv::Vec3b>(row, column) = palette.colours()[pixels.back()];
    }
  out_ << head << compressed(pixels);
  check();
}

void GifWriter::write(const cv::Mat& image) {
  LODESTONE_CHECK(out_.is_open(), "the animation " + file_ + " is finished");
  LODESTONE_CHECK(image.type() == CV_8UC3 && image.size() == size_,
                  "a frame of the animation must be 8-bit BGR of " + std::to_string(size_.width) + "x" +
                      std::to_string(size_.height));
  cv::Mat changed(size_, CV_8UC1, cv::Scalar(255));
  if (frames_ == 0) {
    shown_ = image.clone();
  } else {
    cv::Mat difference;
    cv::absdiff(image, shown_, difference);
    cv::transform(difference, difference, cv::Matx13f(1.0F, 1.0F, 1.0F));
    cv::threshold(difference, changed, kVisible, 255, cv::THRESH_BINARY);
  }
  put_frame(image, changed, delay_cs_);
  ++frames_;
}

void GifWriter::finish(double rest_s) {
  LODESTONE_CHECK(out_.is_open(), "the animation " + file_ + " is finished");
  if (frames_ > 0)
    put_frame(shown_.clone(), cv::Mat::zeros(size_, CV_8UC1),
              std::clamp(static_cast<int>(std::lround(100.0 * rest_s)), kLeastDelay, 65535));
  out_ << ';';
  out_.close();
  check();
}

}  // namespace lodestone::imaging
