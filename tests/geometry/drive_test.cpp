#include "lodestone/geometry/drive.h"

#include <catch2/catch.hpp>
#include <cstddef>
#include <type_traits>

#include "lodestone/geometry/pose2.h"

using namespace lodestone;
using geometry::Drive;
using geometry::Vector2;

TEST_CASE("a drive holds the numbers in its braces, and as many as it was made for in parentheses") {
  CHECK(Drive().size() == 0);
  CHECK(Drive(3).size() == 3);
  const Drive one{3.0};
  REQUIRE(one.size() == 1);
  CHECK(one[0] == 3.0);
  Drive drive = {0.5, -1.0, 0.25};
  CHECK(drive.size() == 3);
  drive = Vector2(2.0, 4.0);
  REQUIRE(drive.size() == 2);
  CHECK(drive == Vector2(2.0, 4.0));
  drive = 0.5 * drive + Drive{1.0, 1.0};
  CHECK(drive == Drive{2.0, 3.0});
  static_assert(!std::is_convertible_v<int, Drive>, "a number is no drive of so many");
}

TEST_CASE("a drive holds no memory of its own, up to the most that there are") {
  const Drive most = Drive::Ones(geometry::kMostDrives);
  const std::ptrdiff_t at = reinterpret_cast<const char*>(most.data()) - reinterpret_cast<const char*>(&most);
  const auto size = static_cast<std::ptrdiff_t>(sizeof(Drive));
  CHECK(at >= 0);
  CHECK(at + geometry::kMostDrives * static_cast<std::ptrdiff_t>(sizeof(double)) <= size);
}

TEST_CASE("numbers in memory are a drive, and those of a pair are called x and y") {
  const float numbers[] = {0.5F, -0.25F, 1.0F};
  CHECK(geometry::as_drive(numbers, 3) == Drive{0.5, -0.25, 1.0});
  CHECK(geometry::number_name(0, 2) == "x");
  CHECK(geometry::number_name(1, 2) == "y");
  CHECK(geometry::number_name(0, 1) == "0");
  CHECK(geometry::number_name(1, 4) == "1");
}

TEST_CASE("the last number of a drive is drawn first") {
  double next = 0.0;
  const Drive drawn = geometry::drawn_drive(3, [&next] { return next += 1.0; });
  CHECK(drawn == Drive{3.0, 2.0, 1.0});
}
