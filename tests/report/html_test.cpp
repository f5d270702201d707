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
  using Range = std::array<double, 2>;
  CHECK(with_interval(0.5, Range{0.25, 0.75}, 1, 100.0, " %") == "50.0 % (25.0 to 75.0)");
  CHECK(with_interval(std::nullopt, Range{0.25, 0.75}, 1) == "–");
  CHECK(with_interval(0.5, std::nullopt, 1) == "–");
  CHECK(grouped(-1234567.0) == "−1\u202f234\u202f567");
}

TEST_CASE("a table aligns numbers right and names the classes of its rows") {
  const std::string html = table({"task", "error"}, {{"centre", "1"}, {"point", "2"}}, 1, {"", "ours"});
  CHECK(holds(html, "<th>task</th><th class=\"number\">error</th>"));
  CHECK(holds(html, "<tr><td>centre</td>"));
  CHECK(holds(html, "<tr class=\"ours\"><td>point</td><td class=\"number\">2</td>"));
}

TEST_CASE("a column without anything in it is taken away") {
  std::vector<std::string> headers = {"task", "error", "heading"};
  std::vector<std::vector<std::string>> rows = {{"point", "–", "–"}, {"square", "1", "–"}};
  drop_empty_columns(headers, rows);
  CHECK(headers == std::vector<std::string>{"task", "error"});
  CHECK(rows == std::vector<std::vector<std::string>>{{"point", "–"}, {"square", "1"}});
  rows.clear();
  drop_empty_columns(headers, rows);
  CHECK(headers.size() == 2);
}
