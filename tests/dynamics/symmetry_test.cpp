#include "symmetry.h"

#include <catch2/catch.hpp>

#include <ATen/ATen.h>

#include "lodestone/common/config.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/nets/tensors.h"
#include "lodestone/physics/rig_description.h"

using namespace lodestone;
using dynamics::seen;
using inference::Symmetry;

namespace {

at::Tensor poses() {
  return nets::tensor_from({0.01, 0.02, 0.3, -0.03, 0.005, -3.0}, {2, 3}).to(at::kDouble);
}

bool alike(const at::Tensor& a, const at::Tensor& b) { return at::allclose(a, b, 0.0, 1e-12); }

}  // namespace

TEST_CASE("a quarter turn takes x to y, and the heading with it", "[unit]") {
  const at::Tensor turned = seen(poses(), 1);
  CHECK(turned[0][0].item<double>() == Approx(-0.02));
  CHECK(turned[0][1].item<double>() == Approx(0.01));
  CHECK(turned[0][2].item<double>() == Approx(0.3 + 0.5 * geometry::kPi));
  CHECK(turned[1][2].item<double>() == Approx(-3.0 + 0.5 * geometry::kPi));
  CHECK(seen(poses(), 2)[1][2].item<double>() == Approx(geometry::kPi - 3.0));  // wrapped
}

TEST_CASE("a mirror takes y and the heading to their opposites", "[unit]") {
  const at::Tensor mirrored = seen(poses(), 4);
  CHECK(mirrored[0][0].item<double>() == Approx(0.01));
  CHECK(mirrored[0][1].item<double>() == Approx(-0.02));
  CHECK(mirrored[0][2].item<double>() == Approx(-0.3));
}

TEST_CASE("the eight ways of a square are a group, each once", "[unit]") {
  CHECK(dynamics::ways_of(Symmetry::kSquare) == 8);
  CHECK(dynamics::ways_of(Symmetry::kNone) == 1);
  for (int a = 0; a < 8; ++a) {
    for (int b = 0; b < 8; ++b) {
      const at::Tensor both = seen(seen(poses(), a), b);
      int matches = 0;
      for (int c = 0; c < 8; ++c) matches += alike(both, seen(poses(), c)) ? 1 : 0;
      CHECK(matches == 1);
    }
  }
}

TEST_CASE("drives turn as positions do", "[unit]") {
  for (int way = 0; way < 8; ++way)
    CHECK(alike(seen(poses().narrow(1, 0, 2), way), seen(poses(), way).narrow(1, 0, 2)));
}

TEST_CASE("a rig has the symmetry that its description says, and square is refused where it does not",
          "[unit]") {
  data::DatasetInfo info;
  physics::RigDescription rig;
  const auto of = [&](Symmetry asked, bool exact = true) {
    info.rig = common::config_to_json(rig);
    info.action_size = rig.drive_size();
    return dynamics::symmetry_of(asked, exact, info, "model.symmetry");
  };
  CHECK(of(Symmetry::kDescribed) == Symmetry::kSquare);  // the paper's
  CHECK(of(Symmetry::kSquare) == Symmetry::kSquare);
  CHECK(of(Symmetry::kNone) == Symmetry::kNone);
  rig.coils.resistance_20C_ohm[2] = 2.5;
  CHECK(of(Symmetry::kDescribed) == Symmetry::kNone);
  CHECK_THROWS_WITH(of(Symmetry::kSquare), Catch::Contains("model.symmetry") && Catch::Contains("differ"));
  CHECK(of(Symmetry::kDescribed, false) == Symmetry::kSquare);  // coils that differ can be learned
  rig = {};
  rig.drive.kind = physics::DriveKind::kIndependent;  // four numbers, each a coil's
  CHECK(of(Symmetry::kDescribed) == Symmetry::kNone);
  CHECK_THROWS_WITH(of(Symmetry::kSquare), Catch::Contains("numbers do not turn"));
  CHECK(of(Symmetry::kDescribed, false) == Symmetry::kNone);
  rig.drive.kind = physics::DriveKind::kField;
  CHECK_THROWS_WITH(of(Symmetry::kSquare), Catch::Contains("drive.kind"));
  info.rig = common::Json::object();  // imported: nobody has said what it is
  CHECK(dynamics::symmetry_of(Symmetry::kDescribed, true, info, "model.symmetry") == Symmetry::kNone);
  CHECK(dynamics::symmetry_of(Symmetry::kSquare, true, info, "model.symmetry") == Symmetry::kSquare);
}
