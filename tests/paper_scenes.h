#pragma once

#include "lodestone/imaging/scene.h"
#include "lodestone/rig/rendered_camera.h"
#include "paper_rig.h"

namespace lodestone::tests {

inline imaging::BenchGeometry paper_bench() { return rig::bench_of(paper_rig()); }

inline imaging::SceneConfig paper_scenes() {
  imaging::SceneConfig scenes;
  scenes.bench = paper_bench();
  return scenes;
}

}  // namespace lodestone::tests
