#include <catch2/catch.hpp>
#include <regex>
#include <set>

#include "lodestone/report/html_page.h"

using lodestone::report::HtmlPage;

namespace {

std::set<std::string> found(const std::string& text, const std::string& pattern) {
  const std::regex regex(pattern);
  std::set<std::string> all;
  for (auto at = std::sregex_iterator(text.begin(), text.end(), regex); at != std::sregex_iterator(); ++at)
    all.insert((*at)[1]);
  return all;
}

}  // namespace

TEST_CASE("every colour and font that the style uses is defined") {
  const std::string html = HtmlPage("").render();
  const std::string style = html.substr(html.find("<style>"), html.find("</style>") - html.find("<style>"));
  const std::set<std::string> defined = found(style, "(--[a-z-]+):");
  CHECK(defined.size() > 8);
  for (const std::string& used : found(style, "var\\((--[a-z-]+)\\)")) {
    CAPTURE(used);
    CHECK(defined.count(used) == 1);
  }
}
