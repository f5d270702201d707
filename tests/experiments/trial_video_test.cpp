#include "lodestone/experiments/trial_video.h"

#include <catch2/catch.hpp>
#include <filesystem>
#include <optional>

#include "lodestone/common/files.h"
#include "lodestone/rig/rendered_camera.h"
#include "temporary_folder.h"

using namespace lodestone;

namespace {

/// Files of a trial of some images, along a path where there is one; `aimed_m`: where the needle is sent.
std::vector<std::string> film(const tests::TemporaryFolder& folder, bool gif, int images,
                              const std::optional<geometry::Path>& path = {},
                              const geometry::Vector2& aimed_m = geometry::Vector2::Zero(),
                              const std::vector<geometry::Stitch>& stitches = {}) {
  experiments::RecordingConfig config;
  config.gif = gif;
  imaging::CameraModel camera;
  experiments::TrialPlan plan;
  plan.task = "point";
  plan.path = path;
  plan.stitches = stitches;
  experiments::TrialVideo video(folder / "trial", config, 0.3, rig::bench_of({}), 15.0, plan);
  for (int i = 0; i < images; ++i) {
    imaging::Frame frame;
    frame.image = cv::Mat(camera.height_px, camera.width_px, CV_8UC3, cv::Scalar(90, 90, 90));
    control::StepRecord step;
    step.time_s = 0.3 * i;
    step.target_m = aimed_m;
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

TEST_CASE("a film shows how the needle shall lie along its path") {
  const tests::TemporaryFolder plain, headed;
  const geometry::Path circle = geometry::Path::circle(0.015);
  film(plain, false, 1, circle);
  film(headed, false, 1, circle.with_heading(geometry::PathHeading::tangent()));
  CHECK(common::read_file(plain / "trial.jpg") != common::read_file(headed / "trial.jpg"));
}

TEST_CASE("a film shows the stitches that a needle is led through") {
  const tests::TemporaryFolder plain, sewn;
  film(plain, false, 1);
  film(sewn, false, 1, {}, geometry::Vector2::Zero(), geometry::running_stitch(3, 0.006, 0.004));
  CHECK(common::read_file(plain / "trial.jpg") != common::read_file(sewn / "trial.jpg"));
}

TEST_CASE("a film shows the target that moves along a path, but of a way to a point where that leads") {
  const tests::TemporaryFolder still, led, first, later;
  const geometry::Vector2 elsewhere(0.01, 0.0);
  film(still, false, 1);
  film(led, false, 1, {}, elsewhere);
  CHECK(common::read_file(still / "trial.jpg") == common::read_file(led / "trial.jpg"));
  film(first, false, 1, geometry::Path::circle(0.015));
  film(later, false, 1, geometry::Path::circle(0.015), elsewhere);
  CHECK(common::read_file(first / "trial.jpg") != common::read_file(later / "trial.jpg"));
}

TEST_CASE("a trial without an image leaves no film") {
  const tests::TemporaryFolder folder;
  CHECK(film(folder, true, 0).empty());
}
