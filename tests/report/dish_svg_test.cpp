#include "lodestone/report/dish_svg.h"

#include <catch2/catch.hpp>

#include "report/small_run.h"

using namespace lodestone::report;
using lodestone::tests::holds;

TEST_CASE("a dish drawing holds what was put into it, with y upwards") {
  DishSvg dish(42.5);
  dish.line({{0.0, 0.0}, {10.0, 20.0}}, "#123456", 1.0, 0.5);
  dish.dot(0.0, 30.0, 1.0, "#abcdef");
  dish.map({{5.0, 5.0, 1.0}}, 5.0, 0.0, 2.0, "error (mm)", 1);
  const std::string svg = dish.svg("a <test>");
  CHECK(svg.rfind("<svg", 0) == 0);
  CHECK(holds(svg, "#123456"));
  CHECK(holds(svg, "error (mm)"));
  CHECK(holds(svg, "a &lt;test&gt;"));
  for (const char* coil : {"+x", "−x", "+y", "−y"}) CHECK(holds(svg, coil));
  // Upwards in the dish is a smaller y in the drawing.
  const std::size_t dot = svg.find("#abcdef");
  const std::size_t circle = svg.rfind("cy=\"", dot);
  REQUIRE(circle != std::string::npos);
  CHECK(std::stod(svg.substr(circle + 4)) < 0.0);
}

TEST_CASE("zones to keep out of are drawn to scale, and cells of one colour where they lie") {
  DrawnRig rig(85.0);  // half a drawing unit per mm
  rig.keep_out = {{{{10.0, 20.0}}, 4.0}, {{{0.0, 0.0}, {10.0, 0.0}, {0.0, 10.0}}, 1.0}};
  DishSvg dish(rig);
  dish.squares({{2.0, 6.0}}, 4.0, "#d5ead9");
  const std::string svg = dish.svg("zones");
  CHECK(holds(svg, "cx=\"5.00\" cy=\"-10.00\" r=\"2.00\""));
  CHECK(holds(svg, "stroke-width=\"1.00\" points=\"0.00,-0.00 5.00,-0.00 0.00,-5.00 \""));
  CHECK(holds(svg, "x=\"0.00\" y=\"-4.00\" width=\"2.00\" height=\"2.00\" fill=\"#d5ead9\""));
  CHECK_FALSE(holds(DishSvg(42.5).svg("none"), "keep-out"));
}

TEST_CASE("coils are drawn the way they stand") {
  DrawnRig rig(17.0);
  rig.coils = {{"low45", 45.0}, {"ring180", 180.0}};
  const std::string svg = DishSvg(rig).svg("other coils");
  CHECK(holds(svg, "rotate(-45.00)"));
  CHECK(holds(svg, "ring180"));
  CHECK(!holds(svg, "+x"));
  const std::size_t name = svg.find(">low45<");
  REQUIRE(name != std::string::npos);
  CHECK(std::stod(svg.substr(svg.rfind(" y=\"", name) + 4)) < 0.0);  // upwards
}

TEST_CASE("the map's scale runs from light to dark and ends at its ends") {
  CHECK(map_colour(0.0) == map_colour(-3.0));
  CHECK(map_colour(1.0) == map_colour(7.0));
  const auto green = [](double t) { return std::stoi(map_colour(t).substr(3, 2), nullptr, 16); };
  CHECK(green(0.0) > green(0.4));
  CHECK(green(0.4) > green(1.0));
}
