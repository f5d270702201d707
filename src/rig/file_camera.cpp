#include "lodestone/rig/file_camera.h"

#include <glob.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <vector>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/imaging/image_file.h"
#include "lodestone/imaging/quiet_stderr.h"

namespace lodestone::rig {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> images_of_folder(const std::string& folder) {
  std::vector<std::string> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file() && imaging::is_image_file(entry.path()))
      files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  if (files.empty())
    throw common::IoError("no images in folder " + folder + " (png, jpg, bmp, tif, ppm, webp)");
  return files;
}

std::vector<std::string> images_of_pattern(const std::string& pattern) {
  glob_t found{};
  std::vector<std::string> files;
  if (::glob(pattern.c_str(), 0, nullptr, &found) == 0)
    files.assign(found.gl_pathv, found.gl_pathv + found.gl_pathc);
  ::globfree(&found);
  std::sort(files.begin(), files.end());
  if (files.empty())
    throw common::IoError("no file matches " + pattern + "; check the folder and the pattern");
  return files;
}

/// Decodes one file as it is stored. Throws HardwareError: for a run, an image that is broken is a camera
/// that fails.
cv::Mat decode(const std::string& file) {
  cv::Mat image;
  try {
    image = imaging::read_image(file);
  } catch (const common::IoError& error) {
    throw common::HardwareError(error.what());
  }
  if (image.channels() == 4) cv::cvtColor(image, image, cv::COLOR_BGRA2BGR);
  return image;
}

}  // namespace

struct FileCamera::Source {
  std::string name;
  std::vector<std::string> files;  ///< empty for a video
  cv::VideoCapture video;
  double frame_rate_hz = 0.0;
  std::int64_t handed_out = 0;

  bool open_video() {
    common::check_is_file(name);
    const imaging::QuietStderr quiet;
    return video.open(name, cv::CAP_FFMPEG);
  }

  void open() {
    if (fs::is_directory(name)) {
      files = images_of_folder(name);
    } else if (!fs::exists(name)) {
      if (name.find_first_of("*?[") == std::string::npos)
        throw common::IoError("no such file or folder: '" + name + "', give images or a video to read");
      files = images_of_pattern(name);
    } else if (imaging::is_image_file(name)) {
      files = {name};
    } else if (!open_video()) {
      throw common::IoError("cannot read " + name +
                            " as a video; give images, or a video such as .mp4 or .avi");
    }
  }

  cv::Mat next() {
    cv::Mat image;
    if (!files.empty()) {
      if (handed_out < static_cast<std::int64_t>(files.size())) image = decode(files[handed_out]);
    } else {
      const imaging::QuietStderr quiet;  // the decoder complains of the last stripe of some Motion JPEG
      video.read(image);
    }
    if (image.empty())
      throw common::HardwareError("camera " + name + " has no more images after " +
                                  std::to_string(handed_out));
    return image;
  }
};

FileCamera::FileCamera(const std::string& source, double frame_rate_hz)
    : source_(std::make_unique<Source>()) {
  if (!(frame_rate_hz > 0.0))
    throw common::ConfigError("frame_rate_hz = " + std::to_string(frame_rate_hz) + ", must be positive");
  source_->name = source;
  source_->frame_rate_hz = frame_rate_hz;
  source_->open();
}

FileCamera::~FileCamera() = default;

imaging::Frame FileCamera::grab(double /*timeout_s*/) {
  imaging::Frame frame;
  frame.image = source_->next();
  frame.stamp_s = static_cast<double>(source_->handed_out) / source_->frame_rate_hz;
  ++source_->handed_out;
  return frame;
}

}  // namespace lodestone::rig
