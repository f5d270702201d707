#pragma once

#include <cstdint>

namespace lodestone::inference {

/// Shape of the segmentation network.
struct UNetConfig {
  static constexpr std::int64_t kClasses = 2;

  std::int64_t width = 16;   ///< channels at the finest level; each level below has twice as many
  std::int64_t depth = 3;    ///< levels below the finest
  std::int64_t stem = 4;     ///< the first layer shrinks the image by this
  std::int64_t upscale = 2;  ///< the last layer enlarges the mask by this

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("width", width, "channels", "channels at the finest level; every level below has twice as many",
            {2, 256});
    v.field("depth", depth, "levels", "levels below the finest", {1, 6});
    v.field("stem", stem, "", "the first layer shrinks the image by this factor", {1, 16});
    v.field("upscale", upscale, "", "the last layer enlarges the mask by this factor", {1, 16});
  }
  /// Sides of an image must be multiples of this.
  std::int64_t multiple() const { return stem << depth; }
  /// The patches of the first layer overlap a little, so that edges between them are seen: they reach so many
  /// pixels over their border.
  std::int64_t stem_border() const { return stem > 1 ? 1 : 0; }
};

}  // namespace lodestone::inference
