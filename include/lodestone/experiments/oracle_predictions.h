#pragma once

#include <cstdint>

#include "lodestone/common/thread_pool.h"
#include "lodestone/data/dataset.h"
#include "lodestone/experiments/collection.h"
#include "lodestone/runs/training_results.h"

namespace lodestone::experiments {

/// How well pulses could be foretold by somebody who knows the rig that answered to them: by a twin of the
/// virtual rig `recorded` with all that is hidden in it, from where the needle was sensed to lie. Only how
/// friction scatters at each pulse it does not know, and gives the mean of `outcomes` draws of that; what is
/// left is due to that scatter, to what the sensor missed, and to what the coils had warmed up by. Like the
/// oracle it belongs to scoring, and no learned simulator can be expected to pass it.
///
/// Rows as evaluate_dynamics() uses them: pulses with current for one step, all of them for several. Throws
/// ConfigError where the rig is not virtual or its needle a sphere, DataError where the data hold no row or
/// are of another drive.
void add_oracle(const CollectionConfig& recorded, const data::Dataset& dataset, std::int64_t outcomes,
                common::ThreadPool& pool, runs::DynamicsBaselines& baselines);

}  // namespace lodestone::experiments
