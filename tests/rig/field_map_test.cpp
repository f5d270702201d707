#include "lodestone/rig/field_map.h"

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/physics/finite_coil.h"
#include "temporary_folder.h"

namespace lodestone::rig {
namespace {

TEST_CASE("points of a CSV, and what is wrong with one") {
  const tests::TemporaryFolder folder;
  const std::string file = folder / "points.csv";
  common::write_file_atomically(file, "x_m,y_m\r\n0.01,-0.02\r\n\n 1e-3 , 0 \n");
  const auto points = read_points_csv(file);
  REQUIRE(points.size() == 2);
  CHECK(points[0] == geometry::Vector2(0.01, -0.02));
  CHECK(points[1] == geometry::Vector2(1e-3, 0.0));

  const char* const bad[][2] = {
      {"x,y\n0,0\n", ":1:1:"},        {"x_m,y_m\n0,0\n0.1,abc\n", ":3:5:"}, {"x_m,y_m\nnan,0\n", ":2:1:"},
      {"x_m,y_m\n0.1\n", ":2:4:"},    {"x_m,y_m\n0.1,0.2,0.3\n", ":2:8:"},  {"x_m,y_m\n0.1,\n", ":2:5:"},
      {"x_m,y_m\n0.1x,1\n", ":2:1:"}, {"x_m,y_m\n", "no points"},           {"", "no points"}};
  for (const auto& row : bad) {
    common::write_file_atomically(file, row[0]);
    CAPTURE(row[0]);
    CHECK_THROWS_WITH(read_points_csv(file), Catch::Contains(row[1]) && Catch::Contains("points.csv"));
    CHECK_THROWS_AS(read_points_csv(file), common::DataError);
  }
  CHECK_THROWS_AS(read_points_csv(folder / "missing.csv"), common::IoError);
}

TEST_CASE("field of each coil at points") {
  const physics::CoilGeometry geometry;
  const double centre = physics::on_axis_per_ampere(geometry, -geometry.centre_distance_m);
  const geometry::Vector2 towards[] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
  const char* const names[] = {"+x", "-x", "+y", "-y"};
  for (int coil = 0; coil < 4; ++coil) {
    CHECK(coil_index(names[coil]) == coil);
    const auto field = field_per_ampere(geometry, coil, {{0.0, 0.0}});
    CHECK((field[0] - centre * towards[coil]).norm() < 1e-9 * centre);
    CHECK_THROWS_AS(field_per_ampere(geometry, coil, {0.06 * towards[coil]}), common::DataError);
  }
  CHECK_THROWS_AS(coil_index("x"), common::ConfigError);
  CHECK(field_csv({{0.5, -0.25}}, {{1.0, 2.0}}) == "x_m,y_m,Bx_T_per_A,By_T_per_A\n0.5,-0.25,1,2\n");
}

TEST_CASE("the plot is a PNG") {
  const tests::TemporaryFolder folder;
  const std::string file = folder / "field.png";
  write_field_plot(file, physics::CoilGeometry{}, 3, 0.0425, {{0.01, 0.01}});
  CHECK(common::read_file(file).substr(1, 3) == "PNG");
  CHECK_THROWS_AS(write_field_plot(folder / "none/field.png", physics::CoilGeometry{}, 0, 0.0425, {}),
                  common::IoError);
}

}  // namespace
}  // namespace lodestone::rig
