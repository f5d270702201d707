#pragma once

#include <cmath>
#include <cstdint>
#include <string>

#include <ATen/ATen.h>

#include "lodestone/common/random.h"
#include "lodestone/data/dataset.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/inference/dynamics_config.h"

namespace lodestone::dynamics::tests {

struct Rows {
  at::Tensor state, action, next_state;  // float64
};

/// Rows over the dish whose motion is some smooth function of state and drive.
inline Rows sample_rows(data::StateLayout layout, std::int64_t count, std::uint64_t seed) {
  common::RandomStream random(seed, "rows");
  const int size = data::state_size(layout);
  Rows rows{at::empty({count, size}, at::kDouble), at::empty({count, 2}, at::kDouble),
            at::empty({count, size}, at::kDouble)};
  auto state = rows.state.accessor<double, 2>();
  auto action = rows.action.accessor<double, 2>();
  auto next = rows.next_state.accessor<double, 2>();
  for (std::int64_t i = 0; i < count; ++i) {
    for (int d = 0; d < 2; ++d) {
      state[i][d] = random.uniform(-0.03, 0.03);
      action[i][d] = random.uniform(-15.0, 15.0);
      next[i][d] = state[i][d] + 3e-4 * action[i][d] * (1.0 + 10.0 * state[i][d]);
    }
    if (size == 3) {
      state[i][2] = random.uniform(-geometry::kPi, geometry::kPi);
      next[i][2] = std::remainder(state[i][2] + 0.02 * action[i][0], 2.0 * geometry::kPi);
    }
  }
  return rows;
}

inline inference::DynamicsConfig config_of(inference::DynamicsForm form, bool batch_norm) {
  inference::DynamicsConfig config;
  config.form = form;
  config.batch_norm = batch_norm;
  config.hidden = {64, 32, 16};
  return config;
}

}  // namespace lodestone::dynamics::tests
