#include "lodestone/report/html_page.h"

#include <catch2/catch.hpp>

#include "report/small_run.h"

using lodestone::report::HtmlPage;
using lodestone::tests::holds;

TEST_CASE("a page holds its sections, its style for light and dark, and its scripts") {
  HtmlPage page("Title <1>");
  page.add_section("first", "One & two", "<p>text</p>");
  const std::string html = page.render();
  CHECK(holds(html, "Title &lt;1&gt;"));
  CHECK(holds(html, "<a href=\"#first\">One &amp; two</a>"));
  CHECK(holds(html, "<section id=\"first\">"));
  CHECK(holds(html, "prefers-color-scheme: dark"));
  CHECK(holds(html, "function lodestone_chart("));
  CHECK(holds(html, "lodestone_enlarge"));
  CHECK(holds(html, "default-src 'none'"));
}
