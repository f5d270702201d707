#include "lodestone/control/rig_identifier.h"

namespace lodestone::control {

void RigIdentifier::reset() {
  filter_.reset();
  drift_.reset();
  watch_.reset();
  unchecked_.reset();
}

void RigIdentifier::learn(const SeenPulse& pulse) {
  gain_before_ = filter_.gain();
  SeenPulse undrifted = pulse;
  const geometry::Vector2 carried_m = drift_.by_flow_m(pulse);
  undrifted.after.x_m -= carried_m.x();
  undrifted.after.y_m -= carried_m.y();
  filter_.learn(undrifted);
  drift_.learn(pulse, filter_.outcomes(pulse.before, pulse.drive_A), filter_.gain().log_sigma);
  unchecked_ = undrifted;
}

void RigIdentifier::check() {
  if (unchecked_) watch_.check(*unchecked_, gain_before_);
  unchecked_.reset();
}

void RigIdentifier::restore(const common::Json& state) {
  reset();
  filter_.restore(state);
}

}  // namespace lodestone::control
