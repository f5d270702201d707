#include "lodestone/physics/field_samples.h"

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "temporary_folder.h"

using namespace lodestone;

namespace {

physics::FieldSamples read(const std::string& text) {
  const tests::TemporaryFolder folder;
  common::write_file_atomically(folder / "samples.csv", text);
  return physics::read_field_samples(folder / "samples.csv");
}

void refused(const std::string& text, const std::string& what) {
  CAPTURE(text);
  CHECK_THROWS_WITH(read(text), Catch::Contains("samples.csv") && Catch::Contains(what));
}

}  // namespace

TEST_CASE("samples are read in the units that their columns name") {
  const auto samples =
      read("I_1_A,I_2_A,x_mm,y_m,z_mm,Bz_uT,Bx_mT,By_T\n2,0,10,0.02,-5,300,1.5,0.004\n0,-1,0,0,0,0,0,0\n");
  CHECK(samples.coils == 2);
  REQUIRE(samples.size() == 2);
  CHECK(samples.position_m[0].isApprox(Eigen::Vector3d(0.01, 0.02, -0.005)));
  CHECK(samples.field_T[0].isApprox(Eigen::Vector3d(1.5e-3, 4e-3, 3e-4)));
  CHECK(samples.current_A[0] == Eigen::Vector2d(2.0, 0.0));
}

TEST_CASE("what a person does wrong is told with the column, or the line") {
  const std::string fields = ",Bx_T,By_T,Bz_T\n";
  refused("x,y_m,z_m,I_1_A" + fields, "no column x_m or x_mm: x says no unit");
  refused("y_m,z_m,I_1_A" + fields, "no column x_m or x_mm");
  refused("x_m,y_m,z_m,I_1_A,Bx_T,By_T\n", "no column Bz_T or Bz_mT or Bz_uT");
  refused("x_m,y_m,z_m" + fields, "no column current_1_A");
  refused("x_m,y_m,z_m,I_1_A,I_3_A" + fields, "I_3_A is there, but no current of coil 2");
  refused("x_m,y_m,z_m,I_1_A" + fields, "holds no row");
  refused("x_m,y_m,z_m,I_1_A" + fields + "0,0,0,1,0,0,x\n", ":2");
  refused("x_m,y_m,z_m,I_1_A" + fields + "20,0,0,1,0,0,0\n", "within +-1 m");
  refused("x_m,y_m,z_m,I_1_A" + fields + "0,0,0,1,25,0,0\n",
          "within +-10 T; is its unit the one that its name says?");
  refused("x_m,y_m,z_m,I_1_A,I_2_A" + fields + "0,0,0,1,0,0,0,0\n", "coil 2 has no current in any row");
  refused("x_m,y_m,z_m,I_1_A,I_2_A" + fields + "0,0,0,1,2,0,0,0\n0,0,0,2,4,0,0,0\n", "always go together");
  refused("x_m,y_m,z_m,I_1_A,I_1_A" + fields, "I_1_A");
}
