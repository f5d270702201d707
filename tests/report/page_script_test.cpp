#include <algorithm>
#include <catch2/catch.hpp>
#include <regex>

#include "lodestone/report/html_page.h"

using lodestone::report::HtmlPage;

TEST_CASE("the script is whole, and charts on a dark ground have the colours that drawings have there") {
  const std::string html = HtmlPage("").render();
  const std::size_t begin = html.find("const lodestone_charts");
  const std::string script = html.substr(begin, html.find("</script>", begin) - begin);
  CHECK(std::count(script.begin(), script.end(), '{') == std::count(script.begin(), script.end(), '}'));
  CHECK(std::count(script.begin(), script.end(), '(') == std::count(script.begin(), script.end(), ')'));
  const std::string style = html.substr(html.find("<style>"), html.find("</style>") - html.find("<style>"));
  const std::regex pair("'(#[0-9a-f]{6})': '(#[0-9a-f]{6})'");
  int colours = 0;
  for (auto at = std::sregex_iterator(script.begin(), script.end(), pair); at != std::sregex_iterator();
       ++at) {
    if (style.find((*at)[1]) == std::string::npos) continue;  // no drawing has it
    CAPTURE((*at)[1].str());
    CHECK(style.find((*at)[2]) != std::string::npos);
    ++colours;
  }
  CHECK(colours >= 3);
}
