#include "lodestone/imaging/scene.h"

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"
#include "paper_scenes.h"

using namespace lodestone;

TEST_CASE("a seed decides the scene, and every factor lies in its range") {
  imaging::SceneConfig config = tests::paper_scenes();
  config.brightness = {0.9, 1.1};
  const imaging::Scene one = imaging::draw_scene(config, 5);
  const imaging::Scene again = imaging::draw_scene(config, 5);
  CHECK(one.brightness == again.brightness);
  CHECK(one.camera.translation_m == again.camera.translation_m);
  CHECK(imaging::draw_scene(config, 6).brightness != one.brightness);
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const imaging::Scene scene = imaging::draw_scene(config, seed);
    CHECK((scene.brightness >= 0.9 && scene.brightness <= 1.1));
    CHECK((scene.bubbles >= 0 && scene.bubbles <= 8));
  }
  CHECK_THROWS_AS(imaging::draw_scene(imaging::SceneConfig{}, 1), common::LogicFault);  // of no rig
}

TEST_CASE("wider ranges keep their middle and the bounds of their keys") {
  imaging::SceneConfig config = tests::paper_scenes();
  config.colour_cast = {0.9, 1.1};
  config.glare = {0.0, 0.4};
  const imaging::SceneConfig wide = imaging::widened(config, 0.5);
  CHECK(wide.colour_cast.low == Approx(0.85));
  CHECK(wide.colour_cast.high == Approx(1.15));
  CHECK(wide.glare.low == 0.0);
  CHECK(wide.glare.high == Approx(0.5));
}
