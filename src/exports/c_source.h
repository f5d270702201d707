#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace lodestone::exports {

/// A number as C has it: "0.0425f".
std::string c_number(double number);
/// A comment, whatever is in the text, with lines of at most 100 characters.
std::string c_comment(const std::string& text);
/// "const KIND NAME[SIZE] LODESTONE_PROGRAM = {...};"
std::string c_array(const std::string& name, const std::vector<float>& numbers);
std::string c_array(const std::string& name, const std::vector<std::int16_t>& numbers);

}  // namespace lodestone::exports
