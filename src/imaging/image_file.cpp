#include "lodestone/imaging/image_file.h"

#include <cctype>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <set>
#include <string_view>
#include <vector>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/imaging/quiet_stderr.h"

namespace lodestone::imaging {
namespace {

constexpr std::size_t kLargestImage = 256 << 20;  // bytes of a file

}  // namespace

bool is_image_file(const std::string& path) {
  static const std::set<std::string> kEndings = {".png",  ".jpg", ".jpeg", ".bmp", ".tif",
                                                 ".tiff", ".ppm", ".pgm",  ".webp"};
  std::string ending = std::filesystem::path(path).extension().string();
  for (char& letter : ending) letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  return kEndings.count(ending) != 0;
}

std::string encoded_image(const cv::Mat& image, const std::string& extension, int jpeg_quality) {
  std::vector<unsigned char> bytes;
  bool encoded = false;
  try {
    encoded = cv::imencode(extension, image, bytes, {cv::IMWRITE_JPEG_QUALITY, jpeg_quality});
  } catch (const cv::Exception&) {  // says no more than that it failed
  }
  if (!encoded) throw common::IoError("the image cannot be encoded as " + extension);
  return {bytes.begin(), bytes.end()};
}

void write_image(const std::string& path, const cv::Mat& image) {
  common::write_file_atomically(path, encoded_image(image, std::filesystem::path(path).extension().string()));
}

cv::Mat read_image(const std::string& path) {
  const std::string bytes = common::read_file(path, kLargestImage);
  cv::Mat image;
  const QuietStderr quiet;
  try {
    const cv::Mat raw(1, static_cast<int>(bytes.size()), CV_8UC1, const_cast<char*>(bytes.data()));
    if (!bytes.empty()) image = cv::imdecode(raw, cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception&) {
    image.release();
  }
  if (image.empty()) throw common::IoError("cannot decode the image " + path + "; is it complete?");
  return image;
}

}  // namespace lodestone::imaging
