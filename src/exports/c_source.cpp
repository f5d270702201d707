#include "c_source.h"

#include <fmt/core.h>

#include <algorithm>

namespace lodestone::exports {
namespace {

constexpr std::size_t kWidth = 100;

template <class Number, class Text>
std::string array(const char* type, const std::string& name, const std::vector<Number>& numbers, Text text) {
  std::string source =
      fmt::format("static const {} {}[{}] LODESTONE_PROGRAM = {{", type, name, numbers.size());
  std::size_t line = kWidth;
  for (const Number number : numbers) {
    const std::string word = text(number) + ",";
    if (line + word.size() > kWidth) {
      source += "\n  ";
      line = 2;
    }
    source += word;
    line += word.size();
  }
  return source + "\n};\n";
}

}  // namespace

std::string c_number(double number) {
  std::string text = fmt::format("{:.9g}", number);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text + "f";
}

std::string c_comment(const std::string& text) {
  std::string lines;
  std::size_t begin = 0;
  while (begin < text.size()) {
    std::size_t end = std::min(text.find('\n', begin), text.size());
    if (end - begin > kWidth - 3) {
      const std::size_t space = text.rfind(' ', begin + kWidth - 3);
      end = space == std::string::npos || space <= begin ? begin + kWidth - 3 : space;
    }
    lines += " * " + text.substr(begin, end - begin) + "\n";
    begin = end + (end < text.size() && (text[end] == ' ' || text[end] == '\n') ? 1 : 0);
  }
  for (std::size_t i = 3; (i = lines.find("*/", i)) != std::string::npos;) lines.insert(i + 1, " ");
  for (std::size_t i = 3; (i = lines.find("/*", i)) != std::string::npos;) lines.insert(i + 1, " ");
  return "/*" + lines.substr(2) + " */\n";
}

std::string c_array(const std::string& name, const std::vector<float>& numbers) {
  return array("float", name, numbers, [](float number) { return c_number(number); });
}

std::string c_array(const std::string& name, const std::vector<std::int16_t>& numbers) {
  return array("int16_t", name, numbers, [](std::int16_t number) { return std::to_string(number); });
}

}  // namespace lodestone::exports
