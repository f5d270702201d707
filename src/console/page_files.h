#pragma once

#include <string>
#include <vector>

namespace lodestone::console {

/// A file of the page, compiled in.
struct PageFile {
  const char* path;  ///< "/console.js"
  const char* content_type;
  std::string content;
};

const std::vector<PageFile>& page_files();

}  // namespace lodestone::console
