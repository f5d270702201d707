#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "lodestone/console/open_file.h"

namespace lodestone::console {

/// A header of an answer. Neither may hold a line break.
struct Header {
  std::string name;
  std::string value;
};

/// The answer to a request: a text, or a part of a file.
struct Response {
  int status = 200;
  std::string content_type = "text/plain; charset=utf-8";
  std::string body;
  std::shared_ptr<const OpenFile> file;  ///< goes instead of `body`:
  std::uint64_t first_byte = 0;          ///< from here,
  std::uint64_t length_bytes = 0;        ///< so much
  std::vector<Header> headers;           ///< besides those of headers_of
};

/// An answer of one line of text.
Response told(int status, const std::string& text);

/// All headers of an answer, but its length: its own, and those that keep pages of other sites away from this
/// one, and this one from them, unless it has them itself.
std::vector<Header> headers_of(const Response& response);

}  // namespace lodestone::console
