#pragma once

#include <cstdint>

namespace lodestone::imaging {

/// What of the bench is seen from above: sizes of dish, coils and needle, in the dish frame (origin at the
/// centre of the dish floor).
struct BenchGeometry {
  double dish_radius_m = 0.0425;     // inner radius at the floor
  double wall_height_m = 0.010;      // D: top of the dish wall above its floor
  double wall_thickness_m = 0.0015;  // D
  double coil_face_m = 0.050;        // face of each coil from the dish centre
  double coil_outer_radius_m = 0.049;
  double coil_bore_radius_m = 0.033;
  double coil_length_m = 0.060;
  double needle_length_m = 0.0235;
  double needle_diameter_m = 0.7176e-3;
  double tape_length_m = 0.003;  // D: bright tape at the head

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("dish_radius_m", dish_radius_m, "m", "inner radius of the dish", {0.005, 0.5});
    v.field("wall_height_m", wall_height_m, "m", "top of the dish wall above its floor", {0.0, 0.1});
    v.field("wall_thickness_m", wall_thickness_m, "m", "thickness of the dish wall", {1e-4, 0.05});
    v.field("coil_face_m", coil_face_m, "m", "distance of the coils' faces from the dish centre",
            {0.005, 1.0});
    v.field("coil_outer_radius_m", coil_outer_radius_m, "m", "outer radius of the coils", {0.001, 1.0});
    v.field("coil_bore_radius_m", coil_bore_radius_m, "m", "inner radius of the coils", {0.0, 1.0});
    v.field("coil_length_m", coil_length_m, "m", "length of the coils along their axes", {0.001, 1.0});
    v.field("needle_length_m", needle_length_m, "m", "length of the needle", {1e-3, 0.2});
    v.field("needle_diameter_m", needle_diameter_m, "m", "outer diameter of the needle", {1e-4, 0.02});
    v.field("tape_length_m", tape_length_m, "m", "length of the tape on its head", {1e-4, 0.1});
  }
};

}  // namespace lodestone::imaging
