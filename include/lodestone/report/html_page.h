#pragma once

#include <string>
#include <utility>
#include <vector>

namespace lodestone::report {

/// One HTML file that holds everything it shows: style, charting library and images. It asks the network
/// for nothing, which a content security policy in its head enforces.
class HtmlPage {
 public:
  explicit HtmlPage(std::string title, std::string subtitle = "");

  /// Appends a section; `id` is its anchor and `content` ready HTML.
  void add_section(const std::string& id, const std::string& title, const std::string& content);
  std::string render() const;

 private:
  struct Section {
    std::string id;
    std::string title;
    std::string content;
  };
  std::string title_;
  std::string subtitle_;
  std::vector<Section> sections_;
};

}  // namespace lodestone::report
