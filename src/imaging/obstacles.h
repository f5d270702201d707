#pragma once

#include "scene_background.h"

namespace lodestone::imaging {

/// Paints the solid bodies on the floor, plain and of one grey, over what else lies there; glare, threads and
/// bubbles stay above them. They look as flat as the floor.
void draw_obstacles(const Scene& scene, SceneLayers& layers);

}  // namespace lodestone::imaging
