#include "lodestone/report/figure_files.h"

#include <catch2/catch.hpp>
#include <string_view>

#include "lodestone/common/error.h"
#include "lodestone/report/charts.h"
#include "lodestone/report/dish_svg.h"
#include "lodestone/report/html_page.h"
#include "report/small_run.h"
#include "temporary_folder.h"

using namespace lodestone;
using tests::holds;

TEST_CASE("the figures of a page are saved as drawings of a journal's widths, and as their data") {
  report::LineChart lines{"learning", "Learning </script>", "steps", "return"};
  lines.series = {{"mean", {{0.0, 1.0}, {10.0, 3.0}}}};
  report::BarChart bars{"bars", "", "task", "error (mm)"};
  bars.categories = {"a", "b"};
  bars.series = {{"policy", {1.0, std::nullopt}}};
  report::DishSvg dish(40.0);
  dish.map({{10.0, -5.0, 0.25}}, 2.0, 0.0, 1.0, "error (mm)", 1);
  dish.line({{0.0, 0.0}, {8.0, 16.0}}, "#123456", 1.0, 1.0);
  dish.dot(3.0, 4.0, 1.0, "#123456");
  dish.target(-1.0, -2.0, 3.0, "#123456");
  report::HtmlPage page("A page");
  page.add_section("s", "Section",
                   report::chart_html(lines) + report::chart_html(bars) + dish.svg("The dish: a map") +
                       dish.svg("The dish: a map"));
  const tests::TemporaryFolder temporary;
  common::write_file_atomically(temporary / "page.html", page.render());
  const std::string folder = temporary / "it's here";
  CHECK(report::save_figures(temporary / "page.html", folder) ==
        std::vector<std::string>{"learning", "bars", "the-dish-a-map", "the-dish-a-map-2"});
  CHECK(common::read_file(folder + "/learning.csv") == "series,steps,return\nmean,0.0,1.0\nmean,10.0,3.0\n");
  CHECK(common::read_file(folder + "/the-dish-a-map.csv") ==
        "kind,number,x_mm,y_mm,value\ncell,0,9.995,-4.998,0.25\nline,0,0.000,0.000,\nline,0,8.000,16.000,\n"
        "dot,0,3.002,4.000,\ntarget,0,-0.998,-1.995,\n");
  for (const char* name : {"learning", "bars", "the-dish-a-map"})
    for (const char* width : {"85", "175"}) {
      const std::string file = folder + "/" + name + "-" + width + "mm";
      CAPTURE(file);
      const std::string svg = common::read_file(file + ".svg");
      CHECK(holds(svg, "xmlns=\"http://www.w3.org/2000/svg\""));
      CHECK(holds(svg, " width=\"" + std::string(width)));
      const std::string pdf = common::read_file(file + ".pdf");
      constexpr std::string_view kBox = "/MediaBox [ 0 0 ";
      const std::size_t box = pdf.find(kBox);
      REQUIRE(box != std::string::npos);
      const double width_pt = std::stod(pdf.substr(box + kBox.size()));
      CHECK(width_pt / 72.0 * 25.4 == Approx(std::stod(width)).epsilon(1e-3));
    }
}

TEST_CASE("a page without figures says so") {
  const tests::TemporaryFolder folder;
  common::write_file_atomically(folder / "page.html", report::HtmlPage("Nothing").render());
  CHECK_THROWS_WITH(report::save_figures(folder / "page.html", folder / "out"),
                    Catch::Contains("holds no figure"));
  common::write_file_atomically(folder / "page.html",
                                "<script>lodestone_chart(\"a\", {\"title\": 1})</script>");
  CHECK_THROWS_WITH(report::save_figures(folder / "page.html", folder / "out"),
                    Catch::Contains("page.html: a chart of it is damaged"));
  CHECK_THROWS_AS(report::save_figures(folder / "none.html", folder / "out"), common::Error);
}
