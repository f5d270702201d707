#pragma once

#include <memory>
#include <utility>

#include "lodestone/control/controller.h"
#include "lodestone/control/inner_controller.h"

namespace lodestone::control {

/// Lets a controller that was made for one rig drive another of its kind: what it asks for is divided by the
/// identified gain of the drive, and it is told its last action as the rig it knows would have had to get it.
/// Changes nothing where the rig is not identified.
class GainCorrection final : public Controller {
 public:
  explicit GainCorrection(std::unique_ptr<Controller> inner) : inner_(std::move(inner)) {}
  void reset() override { inner_->reset(); }
  geometry::Drive act(const task::Observation& observation) override;
  std::unique_ptr<Controller> clone() const override { return inner_.clone_of(*this); }

 private:
  InnerController inner_;
};

}  // namespace lodestone::control
