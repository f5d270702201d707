#include "lodestone/console/served_files.h"

#include <algorithm>
#include <filesystem>
#include <utility>

namespace lodestone::console {

namespace {

constexpr std::size_t kLongestTarget = 2048;

constexpr const char* kOwnOrigin =
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: 'self'; "
    "media-src data: 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'; sandbox "
    "allow-scripts";

struct Kind {
  const char* ending;
  const char* content_type;
  bool may_script;
};

constexpr Kind kKinds[] = {
    {".html", "text/html; charset=utf-8", true},
    {".svg", "image/svg+xml", true},
    {".json", "application/json", false},
    {".csv", "text/csv; charset=utf-8", false},
    {".md", "text/plain; charset=utf-8", false},
    {".txt", "text/plain; charset=utf-8", false},
    {".png", "image/png", false},
    {".jpg", "image/jpeg", false},
    {".gif", "image/gif", false},
    {".mp4", "video/mp4", false},
    {".avi", "video/x-msvideo", false},
};

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::optional<std::string> percent_decoded(const std::string& text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      out += text[i];
      continue;
    }
    const int high = i + 2 < text.size() ? hex_digit(text[i + 1]) : -1;
    const int low = i + 2 < text.size() ? hex_digit(text[i + 2]) : -1;
    if (high < 0 || low < 0) return std::nullopt;
    out += static_cast<char>(high * 16 + low);
    i += 2;
  }
  return out;
}

/// Whether each part of a relative path is a plain name: not empty, not hidden (and so neither `.` nor `..`).
bool has_plain_names(const std::string& path) {
  bool at_start = true;
  for (const char c : path) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f || c == '\\') return false;
    if (at_start && (c == '.' || c == '/')) return false;
    at_start = c == '/';
  }
  return !at_start;
}

const Kind* kind_of(const std::string& path) {
  const std::string ending = std::filesystem::path(path).extension().string();
  const auto* found = std::find_if(std::begin(kKinds), std::end(kKinds),
                                   [&](const Kind& kind) { return ending == kind.ending; });
  return found == std::end(kKinds) ? nullptr : found;
}

/// The file `name` of `folder`; null where a link leads out of the folder or to a hidden file.
std::shared_ptr<const OpenFile> open_below(const std::string& folder, const std::string& name) {
  std::error_code failed;
  const std::string root = std::filesystem::canonical(folder, failed).string();
  if (failed) return nullptr;
  const std::string path = std::filesystem::canonical(root + "/" + name, failed).string();
  if (failed || path.rfind(root + "/", 0) != 0 || !has_plain_names(path.substr(root.size() + 1)))
    return nullptr;
  return OpenFile::open(path);
}

std::optional<std::uint64_t> parse_count(const std::string& digits) {
  if (digits.empty() || digits.size() > 18 || digits.find_first_not_of("0123456789") != std::string::npos)
    return std::nullopt;
  return std::stoull(digits);
}

/// Cuts the answer down to the range that was asked for (RFC 9110, 14.2). Several, and what is no range of
/// bytes, are ignored, as they may be.
void apply_range(const std::string& range, Response& response) {
  const std::string unit = "bytes=";
  const std::size_t dash = range.find('-');
  if (range.rfind(unit, 0) != 0 || dash == std::string::npos) return;
  const std::optional<std::uint64_t> from = parse_count(range.substr(unit.size(), dash - unit.size()));
  const std::optional<std::uint64_t> to = parse_count(range.substr(dash + 1));
  const bool open_ended = dash + 1 == range.size();
  const bool counts_back = dash == unit.size();
  if ((!from && !counts_back) || (!to && !open_ended) || (!from && !to) || (from && to && *to < *from))
    return;
  const std::uint64_t size = response.length_bytes;
  const std::uint64_t first = from ? *from : size - std::min(size, *to);
  if (first >= size) {
    response = told(416, "the file ends before");
    response.headers = {{"Content-Range", "bytes */" + std::to_string(size)}};
    return;
  }
  const std::uint64_t last = from && to ? std::min(*to, size - 1) : size - 1;
  response.status = 206;
  response.first_byte = first;
  response.length_bytes = last - first + 1;
  response.headers.push_back({"Content-Range", "bytes " + std::to_string(first) + "-" + std::to_string(last) +
                                                   "/" + std::to_string(size)});
}

}  // namespace

std::optional<Response> ServedFiles::find(const RequestHead& head) const {
  const auto root = std::find_if(roots_.begin(), roots_.end(), [&](const Root& candidate) {
    return head.target.rfind(candidate.prefix, 0) == 0;
  });
  if (root == roots_.end()) return std::nullopt;
  const Response none = told(404, "no such file");
  if (head.target.size() > kLongestTarget) return none;
  const std::string path = head.target.substr(0, head.target.find_first_of("?#"));
  if (path.size() < root->prefix.size()) return none;
  const std::optional<std::string> name = percent_decoded(path.substr(root->prefix.size()));
  if (!name || !has_plain_names(*name) || kind_of(*name) == nullptr) return none;
  Response response;
  response.file = open_below(root->folder, *name);
  if (!response.file) return none;
  const Kind* kind = kind_of(response.file->path());  // of what a link leads to
  if (kind == nullptr) return none;
  response.length_bytes = response.file->size_bytes();
  response.content_type = kind->content_type;
  response.headers.push_back({"Accept-Ranges", "bytes"});
  if (kind->may_script) response.headers.push_back({"Content-Security-Policy", kOwnOrigin});
  apply_range(head.range, response);
  return response;
}

}  // namespace lodestone::console
