#include "teleoperation_window.h"

#include <SDL.h>

#include <catch2/catch.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "lodestone/common/interrupt.h"

using namespace lodestone;

namespace {

void press(SDL_Keycode key, bool down = true) {
  SDL_Event event{};
  event.type = down ? SDL_KEYDOWN : SDL_KEYUP;
  event.key.keysym.sym = key;
  SDL_PushEvent(&event);
}

}  // namespace

TEST_CASE("keys hold a drive, set its strength and end an episode") {
  common::install_interrupt_handler();
  experiments::CollectionConfig config;
  config.sensor.kind = "simulated";
  const std::unique_ptr<session::RigSession> bench = experiments::make_exploration_session(config);
  apps::TeleoperationWindow window("keyboard", physics::RigDescription{});
  experiments::Teleoperator teleoperator = window.teleoperator(*bench);
  const task::Observation nothing;
  CHECK(teleoperator.controller->act(nothing).isZero());
  press(SDLK_RIGHT);
  press(SDLK_DOWN);
  CHECK(teleoperator.controller->act(nothing) == geometry::Vector2(0.5, -0.5));
  press(SDLK_PLUS);
  press(SDLK_DOWN, false);
  CHECK(teleoperator.controller->act(nothing).isApprox(geometry::Vector2(0.6, 0.0)));
  press(SDLK_RIGHT, false);
  CHECK(teleoperator.controller->act(nothing).isZero());
  CHECK_FALSE(teleoperator.episode_over());
  press(SDLK_n);
  CHECK(teleoperator.episode_over());
  teleoperator.controller->reset();
  CHECK_FALSE(teleoperator.episode_over());
  teleoperator.watch({});
  press(SDLK_ESCAPE);
  CHECK(teleoperator.episode_over());  // the episode is saved before the run ends
  CHECK_FALSE(common::interrupted());
  teleoperator.controller->reset();
  CHECK(common::interrupted());
}

TEST_CASE("what the teleoperator sees is painted: map, needle and currents") {
  apps::PilotView view;
  view.visits.assign(static_cast<std::size_t>(apps::kPilotGrid) * apps::kPilotGrid, 0);
  const cv::Mat empty = apps::paint_pilot_view(view);
  CHECK(empty.size() == cv::Size(960, 540));
  view.visits[0] = 4;
  view.visits[70] = 9;
  view.drive = {0.4, -0.7};
  view.step.estimate.valid = true;
  view.step.estimate.pose = {0.01, -0.005, 1.0};
  view.image = cv::Mat(1024, 1280, CV_8UC3, cv::Scalar(150, 180, 160));
  view.steps = 120;
  view.episodes = 6;
  const cv::Mat full = apps::paint_pilot_view(view);
  cv::imwrite("teleoperator.png", full);
  cv::Mat differs;
  cv::absdiff(empty, full, differs);
  cv::cvtColor(differs, differs, cv::COLOR_BGR2GRAY);
  CHECK(cv::countNonZero(differs(cv::Rect(8, 8, 640, 512))) > 300000);   // the image
  CHECK(cv::countNonZero(differs(cv::Rect(664, 30, 280, 280))) > 800);   // the map
  CHECK(cv::countNonZero(differs(cv::Rect(664, 350, 280, 60))) > 1000);  // the currents
  view.dish_radius_m = 0.0425;
  const cv::Mat arrow = apps::paint_pilot_view(view);
  view.sphere = true;  // a point instead
  cv::absdiff(apps::paint_pilot_view(view), arrow, differs);
  cv::cvtColor(differs, differs, cv::COLOR_BGR2GRAY);
  CHECK(cv::countNonZero(differs(cv::Rect(664, 30, 280, 280))) > 20);
  CHECK(cv::countNonZero(differs(cv::Rect(8, 8, 640, 512))) == 0);
}
