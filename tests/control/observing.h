#pragma once

#include "lodestone/control/observer_config.h"

namespace lodestone::tests {

/// With both estimators at work, which by themselves are off.
inline control::ObserverConfig observing() {
  control::ObserverConfig config;
  config.first_gain = 1.0;
  config.gain_share = 0.4;
  config.disturbance_share = 0.3;
  config.reaching_share = 0.8;
  return config;
}

}  // namespace lodestone::tests
