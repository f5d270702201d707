#pragma once

#include <optional>

#include "lodestone/data/dataset.h"
#include "lodestone/dynamics/model.h"
#include "lodestone/runs/training_results.h"

namespace lodestone::dynamics {

/// How often the recorded motions of `table`, rows of the model's layout, lie in the regions in which the
/// model expects 50, 90 and 99 % of them: the smallest such regions (of highest density: Hyndman, Computing
/// and graphing highest density regions, 1996) of the mixture that all members together predict. Nothing
/// where single values are predicted, which have no regions.
///
/// A motion lies in the region of p when it is among the densest p of 1000, itself and 999 draws from the
/// mixture: of a model that is right that has probability p exactly, however rough so few draws are. Headings
/// are on the circle. Every row draws from a stream of its own, so the result depends on nothing but model
/// and rows. Of more than 10,000 rows that many at most are taken, evenly.
///
/// Rows hold what a sensor saw, in training as here, so the mixture has learned the sensor's noise, at both
/// ends of a pulse, along with the motion: none is added or taken away. The shares are those of what the
/// sensor sees next; against a better one, or the true pose, the same mixture is too wide, against a worse
/// one too narrow. Where there is no noise, a needle that stays lies at the peak of the narrowest component:
/// a region for less than the probability of staying then holds too much.
std::optional<runs::RegionCoverage> region_coverage(const Model& model, const data::TransitionTable& table);

}  // namespace lodestone::dynamics
