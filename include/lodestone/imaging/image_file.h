#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

namespace lodestone::imaging {

/// Whether the file's ending is that of an image, rather than of a video.
bool is_image_file(const std::string& path);

/// The bytes of an image file: `extension` ".png" or ".jpg", the latter of this quality (0 to 100). Throws
/// IoError.
std::string encoded_image(const cv::Mat& image, const std::string& extension, int jpeg_quality = 85);

/// Writes an image by its file's ending, whole or not at all. Throws IoError (disk full, no permission).
void write_image(const std::string& path, const cv::Mat& image);

/// An image as it is stored. Throws IoError naming the path when it is no file, or no image that can be
/// decoded.
cv::Mat read_image(const std::string& path);

}  // namespace lodestone::imaging
