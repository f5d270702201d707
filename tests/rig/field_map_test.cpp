#include "lodestone/rig/field_map.h"

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/physics/finite_coil.h"
#include "temporary_folder.h"

namespace lodestone::rig {
namespace {

TEST_CASE("field of each coil at points") {
  const physics::CoilsDescription coils;
  const physics::CoilGeometry& geometry = coils.geometry;
  const double centre = physics::on_axis_per_ampere(geometry, -geometry.centre_distance_m);
  const geometry::Vector2 towards[] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
  const char* const names[] = {"+x", "-x", "+y", "-y"};
  for (std::size_t coil = 0; coil < 4; ++coil) {
    CHECK(coil_index(coils, names[coil]) == coil);
    const auto field = field_per_ampere(coils, coil, {{0.0, 0.0}});
    CHECK((field[0].head<2>() - centre * towards[coil]).norm() < 1e-9 * centre);
    CHECK(std::abs(field[0].z()) < 1e-9 * centre);
    CHECK_THROWS_AS(
        field_per_ampere(coils, coil,
                         {geometry::Vector2(0.06 * towards[coil] + 0.04 * towards[(coil + 2) % 4])}),
        common::DataError);
  }
  CHECK_THROWS_WITH(coil_index(coils, "x"), Catch::Contains("it is one of +x, -x, +y and -y"));
  CHECK(field_csv({{0.5, -0.25}}, {{1.0, 2.0, 3.0}}) ==
        "x_m,y_m,Bx_T_per_A,By_T_per_A,Bz_T_per_A\n0.5,-0.25,1,2,3\n");
}

TEST_CASE("the plot is a PNG") {
  const tests::TemporaryFolder folder;
  const std::string file = folder / "field.png";
  const physics::CoilsDescription coils;
  write_field_plot(file, coils, 3, 0.0425, {{0.01, 0.01}});
  CHECK(common::read_file(file).substr(1, 3) == "PNG");
  CHECK_THROWS_AS(write_field_plot(folder / "none/field.png", coils, 3, 0.0425, {}), common::IoError);
}

}  // namespace
}  // namespace lodestone::rig
