#include "lodestone/report/html.h"

#include <catch2/catch.hpp>

#include "report/small_run.h"

using namespace lodestone::report;
using lodestone::tests::holds;

TEST_CASE("text is made safe and numbers are written as readers expect") {
  CHECK(escape("<b>&\"'") == "&lt;b&gt;&amp;&quot;&#39;");
  CHECK(fixed(1.256, 2) == "1.26");
  CHECK(fixed(std::nullopt, 2) == "–");
  CHECK(plus_minus(6.3, 2.1, 1) == "6.3 ± 2.1");
  CHECK(plus_minus(6.3, std::nullopt, 1) == "6.3");
  CHECK(percent(0.87).rfind("87", 0) == 0);
  CHECK(grouped(-1234567.0) == "−1\u202f234\u202f567");
}

TEST_CASE("a table aligns numbers right and names the classes of its rows") {
  const std::string html = table({"task", "error"}, {{"centre", "1"}, {"point", "2"}}, 1, {"", "ours"});
  CHECK(holds(html, "<th>task</th><th class=\"number\">error</th>"));
  CHECK(holds(html, "<tr><td>centre</td>"));
  CHECK(holds(html, "<tr class=\"ours\"><td>point</td><td class=\"number\">2</td>"));
}
