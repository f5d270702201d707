#include "lodestone/control/rig_identifier.h"

namespace lodestone::control {

void RigIdentifier::reset() {
  filter_.reset();
  watch_.reset();
  unchecked_.reset();
}

void RigIdentifier::learn(const SeenPulse& pulse) {
  gain_before_ = filter_.gain();
  filter_.learn(pulse);
  unchecked_ = pulse;
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
