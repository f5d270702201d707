#pragma once

#include <memory>
#include <utility>

#include "lodestone/control/controller.h"

namespace lodestone::control {

/// The controller inside another one; copied with it.
class InnerController {
 public:
  InnerController(std::unique_ptr<Controller> controller)  // NOLINT(google-explicit-constructor)
      : controller_(std::move(controller)) {}
  InnerController(const InnerController& other) : controller_(other->clone()) {}
  InnerController(InnerController&&) = default;
  InnerController& operator=(InnerController other) noexcept {
    controller_ = std::move(other.controller_);
    return *this;
  }
  ~InnerController() = default;

  Controller* operator->() const { return controller_.get(); }

  /// A clone of the controller around this one; nothing where this one has none.
  template <class Outer>
  std::unique_ptr<Controller> clone_of(const Outer& outer) const {
    if (controller_->clone() == nullptr) return nullptr;
    return std::make_unique<Outer>(outer);
  }

 private:
  std::unique_ptr<Controller> controller_;
};

}  // namespace lodestone::control
