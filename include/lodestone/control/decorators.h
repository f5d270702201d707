#pragma once

#include <memory>

#include "lodestone/control/controller.h"
#include "lodestone/control/inner_controller.h"
#include "lodestone/physics/coil_drive.h"

namespace lodestone::control {

/// What is put around a controller. The defaults change nothing: that is the paper's controller.
struct DecoratorConfig {
  double stall_gain = 1.0;
  double stall_gain_max = 8.0;
  double stall_threshold_m = 0.0015;
  double stall_threshold_deg = 6.0;
  double direction_dither_deg = 0.0;
  double direction_dither_fraction = 1.0;
  double hold_radius_m = 0.0;
  double hold_heading_deg = 10.0;
  double lead_s = 0.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("stall_gain", stall_gain, "", "factor on the command per step without motion; 1 is off",
            {1.0, 4.0});
    v.field("stall_gain_max", stall_gain_max, "", "largest factor that may build up", {1.0, 1000.0});
    v.field("stall_threshold_m", stall_threshold_m, "m",
            "a sensed step shorter than this is no motion (above the noise from image to image)", {0.0, 0.1});
    v.field("stall_threshold_deg", stall_threshold_deg, "deg", "nor is a turn smaller than this",
            {0.0, 180.0});
    v.field(
        "direction_dither_deg", direction_dither_deg, "deg",
        "a needle that the full command does not move is pulled this much to one side, then the other, then "
        "further; 0 is off",
        {0.0, 90.0});
    v.field("direction_dither_fraction", direction_dither_fraction, "",
            "fraction of the full command that such a pull has: turning takes less current than pulling",
            {0.01, 1.0});
    v.retired("stall_swing_deg", "direction_dither_deg");
    v.retired("stall_swing_strength", "direction_dither_fraction");
    v.field("hold_radius_m", hold_radius_m, "m",
            "no current while sensed within this of the target; 0 is off", {0.0, 0.1});
    v.field("hold_heading_deg", hold_heading_deg, "deg",
            "and, where the target has a heading, within this of it", {0.0, 180.0});
    v.field("lead_s", lead_s, "s",
            "along a path the needle is sent to where its target will be so much later, but not around a "
            "corner: what "
            "chases a moving point comes late by about its own time to get there; 0 is off",
            {0.0, 6.0});
  }
};

/// Multiplies the command by a factor that grows with every step without motion and returns to 1 after
/// motion: a memoryless policy below the break-away current would repeat itself for ever (rig-physics.md).
/// Where even the full command moves nothing (the dead zones between two coils), its direction is dithered:
/// that turns the needle.
class AdaptiveGain final : public Controller {
 public:
  /// `drive`: what an action's direction is.
  AdaptiveGain(std::unique_ptr<Controller> inner, const DecoratorConfig& config,
               const physics::CoilDrive& drive = {});
  void reset() override;
  geometry::Drive act(const task::Observation& observation) override;
  std::unique_ptr<Controller> clone() const override { return inner_.clone_of(*this); }
  double gain() const { return gain_; }

 private:
  geometry::Drive dithered(const geometry::Drive& action) const;

  InnerController inner_;
  DecoratorConfig config_;
  physics::CoilDrive drive_;
  double gain_ = 1.0;
  int full_stalls_ = 0;  // steps in a row that the full command did not move the needle
  bool full_ = false;    // the last command was the full one
  bool acted_ = false;   // the last step gave a command, so a lack of motion means a stall
  geometry::Pose2 last_pose_;
};

/// Gives no current while the needle is sensed within the hold radius, and at the target's heading where it
/// has one. A target that moves takes both along: what lies well where it is now is left until it is not.
class Hold final : public Controller {
 public:
  Hold(std::unique_ptr<Controller> inner, const DecoratorConfig& config)
      : inner_(std::move(inner)), config_(config) {}
  void reset() override { inner_->reset(); }
  geometry::Drive act(const task::Observation& observation) override;
  std::unique_ptr<Controller> clone() const override { return inner_.clone_of(*this); }

 private:
  InnerController inner_;
  DecoratorConfig config_;
};

/// Sends the needle to where a moving target will be, so that it arrives with it: as far ahead as the way
/// there is straight, so that no corner is cut.
class Lead final : public Controller {
 public:
  Lead(std::unique_ptr<Controller> inner, const DecoratorConfig& config)
      : inner_(std::move(inner)), lead_s_(config.lead_s) {}
  void reset() override { inner_->reset(); }
  geometry::Drive act(const task::Observation& observation) override;
  std::unique_ptr<Controller> clone() const override { return inner_.clone_of(*this); }

 private:
  InnerController inner_;
  double lead_s_;
};

/// Lead around hold around adaptive gain around `controller`, each only where the configuration turns it on.
std::unique_ptr<Controller> decorate(std::unique_ptr<Controller> controller, const DecoratorConfig& config,
                                     const physics::CoilDrive& drive = {});

}  // namespace lodestone::control
