#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "lodestone/experiments/collection.h"

namespace lodestone::apps {

/// What the teleoperator sees of one moment.
struct PilotView {
  cv::Mat image;  ///< 8-bit BGR; empty where there is no camera
  control::StepRecord step;
  geometry::Vector2 drive = geometry::Vector2::Zero();  ///< as held now, -1 to 1
  double max_current_A = 15.0;
  double dish_radius_m = 0.0;
  bool sphere = false;               ///< shown without a heading
  std::vector<std::int64_t> visits;  ///< per cell of a square grid over the dish, row by row from -y
  std::int64_t steps = 0;
  std::int64_t episodes = 0;
};

constexpr int kPilotGrid = 12;  ///< cells along a side of the coverage map

/// Paints the window: image, coverage map, currents, counts. 960 x 540, 8-bit BGR.
cv::Mat paint_pilot_view(const PilotView& view);

/// The window of `collect --by keyboard|gamepad`. Arrow keys or the left stick hold a drive; + and - set its
/// strength on the keyboard; N ends the episode; Escape or closing the window ends the run.
class TeleoperationWindow {
 public:
  /// Throws HardwareError when there is no display, or no gamepad where one is asked for.
  TeleoperationWindow(const std::string& by, const physics::RigDescription& rig);
  ~TeleoperationWindow();
  TeleoperationWindow(const TeleoperationWindow&) = delete;
  TeleoperationWindow& operator=(const TeleoperationWindow&) = delete;

  /// `bench` gives the images and must outlive the teleoperator.
  experiments::Teleoperator teleoperator(session::RigSession& bench);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lodestone::apps
