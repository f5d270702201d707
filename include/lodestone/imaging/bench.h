#pragma once

#include <vector>

#include "lodestone/geometry/pose2.h"

namespace lodestone::imaging {

/// What of the bench is seen from above: sizes of dish, coils and needle, in the dish frame (origin at the
/// centre of the dish floor).
struct BenchGeometry {
  double dish_radius_m = 0.0;  ///< inner radius at the floor
  double wall_height_m = 0.0;  ///< top of the dish wall above its floor
  double wall_thickness_m = 0.0;
  double coil_face_m = 0.0;  ///< face of each of four coils from the dish centre, or side of the holder that
                             ///< is there in their place
  std::vector<geometry::Vector2> coil_directions = {
      {1.0, 0.0}, {-1.0, 0.0}, {0.0, 1.0}, {0.0, -1.0}};  ///< towards each coil
  double coil_outer_radius_m = 0.0;
  double coil_bore_radius_m = 0.0;
  double coil_length_m = 0.0;
  double needle_length_m = 0.0;
  double needle_diameter_m = 0.0;
  double tape_length_m = 0.0;  ///< bright tape at the head
  bool sphere = false;         ///< it is one, as long as thick, without tape; its heading says nothing
  double fluid_depth_m = 0.0;  ///< that the floor is seen through; 0: as if there were none
  double refractive_index = 1.0;
  /// Outlines of solid bodies on the floor, corner by corner. No description tells of them: a bench that is
  /// looked for in images has none.
  std::vector<std::vector<geometry::Vector2>> obstacles_m;
};

}  // namespace lodestone::imaging
