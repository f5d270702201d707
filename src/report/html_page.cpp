#include "lodestone/report/html_page.h"

#include "lodestone/report/chart_js.h"
#include "lodestone/report/html.h"
#include "page_assets.h"

namespace lodestone::report {

HtmlPage::HtmlPage(std::string title, std::string subtitle)
    : title_(std::move(title)), subtitle_(std::move(subtitle)) {}

void HtmlPage::add_section(const std::string& id, const std::string& title, const std::string& content) {
  sections_.push_back({id, title, content});
}

std::string HtmlPage::render() const {
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src "
      "'unsafe-inline'; "
      "style-src 'unsafe-inline'; img-src data:\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
      escape(title_) + "</title>\n<style>" + kPageStyle + "</style>\n<script>" + kChartJs +
      "</script>\n<script>" + kPageScript + "</script>\n</head>\n<body>\n<header><h1>" + escape(title_) +
      "</h1>";
  if (!subtitle_.empty()) html += "<p class=\"subtitle\">" + escape(subtitle_) + "</p>";
  html += "</header>\n<nav>";
  for (const Section& section : sections_)
    html += "<a href=\"#" + escape(section.id) + "\">" + escape(section.title) + "</a>";
  html += "</nav>\n<main>\n";
  for (const Section& section : sections_)
    html += "<section id=\"" + escape(section.id) + "\"><h2>" + escape(section.title) + "</h2>\n" +
            section.content + "</section>\n";
  return html +
         "</main>\n<footer>Made by <code>lodestone report</code>. Charts: Chart.js (MIT licence), "
         "contained in this file.</footer>\n</body>\n</html>\n";
}

}  // namespace lodestone::report
