#pragma once

#include "lodestone/vision/rod_fit.h"

namespace lodestone::vision {

/// The same for a sphere, `config.sphere`: clusters of the mask -> those of which a disc of the sphere's
/// diameter explains the probability -> their middles, by the mean of all pixels nearby, weighted by
/// probability. Headings are 0 and certain, as a sphere has none. What is much larger than the sphere is not
/// it.
RodFit fit_disc(const Evidence& evidence, const MaskGrid& grid, const RodConfig& config);

}  // namespace lodestone::vision
