#pragma once

#include <optional>
#include <vector>

#include "lodestone/common/json.h"
#include "lodestone/console/bench_state.h"
#include "lodestone/console/messages.h"
#include "lodestone/physics/modelled_field.h"
#include "lodestone/physics/rig_description.h"
#include "lodestone/safety/supervisor.h"

namespace lodestone::console {

/// Takes places of the dish into the image, and back, as fractions of the image.
class ImageMap {
 public:
  explicit ImageMap(const imaging::CameraModel& camera) : camera_(camera) {}
  ImagePlace to_image(const geometry::Vector2& point_m) const;
  geometry::Vector2 to_dish(const ImagePlace& place) const;
  common::Json json(const geometry::Vector2& point_m) const;
  common::Json json(const std::vector<geometry::Vector2>& points_m) const;

 private:
  imaging::CameraModel camera_;
};

/// What is drawn over the image, and the figures beside it: a bench's state as the page has it
/// (docs/console-protocol.md), without what belongs to pages.
class LiveView {
 public:
  LiveView(const physics::RigDescription& rig, const safety::SafetyConfig& safety)
      : rig_(rig), safety_(safety), field_(rig) {}
  common::Json json(const BenchState& state) const;
  static common::Json json(const BenchSample& sample);

 private:
  common::Json pose(const BenchState& state, const std::optional<ImageMap>& map) const;
  void draw(const BenchState& state, const ImageMap& map, common::Json& view) const;
  common::Json field(const BenchState& state, const ImageMap& map) const;
  common::Json limits(const BenchState& state) const;

  physics::RigDescription rig_;
  safety::SafetyConfig safety_;
  physics::ModelledField field_;
};

}  // namespace lodestone::console
