#include "lodestone/experiments/trial_video.h"

#include <catch2/catch.hpp>
#include <filesystem>

#include "lodestone/rig/rendered_camera.h"
#include "temporary_folder.h"

using namespace lodestone;

namespace {

/// Files of a trial of three images.
std::vector<std::string> film(const tests::TemporaryFolder& folder, bool gif, int images) {
  experiments::RecordingConfig config;
  config.gif = gif;
  imaging::CameraModel camera;
  experiments::TrialPlan plan;
  plan.task = "point";
  experiments::TrialVideo video(folder / "trial", config, 0.3, rig::bench_of({}), 15.0, plan);
  for (int i = 0; i < images; ++i) {
    imaging::Frame frame;
    frame.image = cv::Mat(camera.height_px, camera.width_px, CV_8UC3, cv::Scalar(90, 90, 90));
    control::StepRecord step;
    step.time_s = 0.3 * i;
    step.estimate.reason = "no needle in the image";
    video.show(frame, camera, step);
  }
  video.finish();
  std::vector<std::string> files;
  for (const auto& file : std::filesystem::directory_iterator(folder.path())) {
    files.push_back(file.path().filename());
    CHECK(file.file_size() > 100);
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

TEST_CASE("a film, its last image and, where asked for, a GIF lie beside each other") {
  const tests::TemporaryFolder plain;
  CHECK(film(plain, false, 3) == std::vector<std::string>{"trial.jpg", "trial.mp4"});
  const tests::TemporaryFolder with_gif;
  CHECK(film(with_gif, true, 3) == std::vector<std::string>{"trial.gif", "trial.jpg", "trial.mp4"});
}

TEST_CASE("a trial without an image leaves no film") {
  const tests::TemporaryFolder folder;
  CHECK(film(folder, true, 0).empty());
}
