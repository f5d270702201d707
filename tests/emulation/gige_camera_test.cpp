#include "gige_camera.h"

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"

using namespace lodestone;

TEST_CASE("two emulated cameras never share the one address there is") {
  const auto image = [] { return cv::Mat(64, 64, CV_8UC3, cv::Scalar(1, 2, 3)); };
  std::unique_ptr<emulation::GigeCamera> first;
  try {
    first = std::make_unique<emulation::GigeCamera>(image);
  } catch (const common::HardwareError&) {  // another program's bench has it
    return;
  }
  CHECK(first->name() == "Aravis-Fake-" + first->serial());
  CHECK_THROWS_WITH(emulation::GigeCamera(image), Catch::Contains("in use"));
  first.reset();
  CHECK_NOTHROW(emulation::GigeCamera(image));
}
