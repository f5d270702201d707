#pragma once

namespace lodestone::imaging {

/// Binary places of the fixed-point coordinates that OpenCV's drawing functions take: sixteenths of a pixel.
constexpr int kShift = 4;

}  // namespace lodestone::imaging
