#pragma once

#include <string>
#include <utility>
#include <vector>

namespace lodestone::report {

/// Points in mm in the dish frame: x to coil +x (right), y to coil +y (up).
using Points = std::vector<std::pair<double, double>>;

/// One square cell of a map.
struct MapCell {
  double x_mm = 0.0;  ///< its centre
  double y_mm = 0.0;
  double value = 0.0;
};

/// A zone to keep out of: all within `radius_mm` of the filled polygon of its corners.
struct DrawnZone {
  Points corners_mm;
  double radius_mm = 0.0;
};

/// What a drawing shows of a rig: the zones that its needle must keep out of, its dish, and coils,
/// schematically, the way they stand from the dish centre (degrees from +x towards +y).
struct DrawnRig {
  struct Coil {
    std::string name;
    double direction_deg = 0.0;
  };
  /// The four around the dish.
  DrawnRig(double dish_radius_mm) : radius_mm(dish_radius_mm) {}

  double radius_mm;
  std::vector<DrawnZone> keep_out = {};
  std::vector<Coil> coils = {{"+x", 0.0}, {"−x", 180.0}, {"+y", 90.0}, {"−y", 270.0}};
};

/// A drawing of the dish seen from above, with its coils (schematic), axes in mm and what is put in it.
/// Things drawn later lie on top; lines may leave the dish. Positions and lengths called _mm are true to
/// scale; line widths and dots are in drawing units, of which the dish radius has 42.5.
class DishSvg {
 public:
  /// `compact` leaves out tick labels, for small panels.
  explicit DishSvg(const DrawnRig& rig, bool compact = false);

  /// Coloured cells of a side length, on a scale from `low` to `high`; a colour bar with `legend` (name and
  /// unit) stands on the right. Cells are clipped to the dish.
  void map(const std::vector<MapCell>& cells, double side_mm, double low, double high,
           const std::string& legend, int decimals);
  /// Square cells of one colour, by their middles, clipped to the dish.
  void squares(const Points& centres_mm, double side_mm, const std::string& colour);
  void line(const Points& points, const std::string& colour, double width, double opacity,
            bool dashed = false);
  /// Filled, or a ring when `hollow`.
  void dot(double x_mm, double y_mm, double radius, const std::string& colour, bool hollow = false,
           double opacity = 1.0);
  /// A cross within a circle of `radius_mm` (the distance that counts as reached).
  void target(double x_mm, double y_mm, double radius_mm, const std::string& colour);

  /// The finished <svg> element; `label` describes it to those who cannot see it.
  std::string svg(const std::string& label) const;

 private:
  DrawnRig rig_;
  double scale_;  // drawing units per mm
  bool compact_;
  std::string cells_;
  std::string marks_;
  std::string legend_;
};

/// Colour at `t` in [0, 1] of the scale that maps use, light to dark.
std::string map_colour(double t);

}  // namespace lodestone::report
