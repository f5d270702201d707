#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodestone/console/request_head.h"
#include "lodestone/console/response.h"

namespace lodestone::console {

/// The files below some folders that a browser may read: those with an ending that a browser shows, as they
/// lie there, and never a hidden one or one that a link leads out to. Folders are not listed.
class ServedFiles {
 public:
  struct Root {
    std::string prefix;  ///< of the target, as `/runs/`
    std::string folder;  ///< what it stands for; may appear later
  };

  explicit ServedFiles(std::vector<Root> roots) : roots_(std::move(roots)) {}

  /// The file, or the part of it that `Range` asks for; 404 where there is none that may be read. Nothing
  /// where the target is below no prefix. Pages that were written by others (HTML, SVG) run in an origin of
  /// their own: they see neither the console nor each other.
  std::optional<Response> find(const RequestHead& head) const;

 private:
  std::vector<Root> roots_;
};

}  // namespace lodestone::console
