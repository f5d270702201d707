#pragma once

#include "lodestone/common/random.h"
#include "scene_background.h"

namespace lodestone::imaging {

/// Paints what may be mistaken for a needle or hides it: stains, scratches and some threads below it; other
/// threads and bubbles above it.
void draw_distractors(const Scene& scene, common::RandomStream& random, SceneLayers& layers);

}  // namespace lodestone::imaging
