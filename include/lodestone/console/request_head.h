#pragma once

#include <string>

namespace lodestone::console {

/// What a browser or a program asks for, without the rest of its request. A header that is not there is
/// empty; none is there twice.
struct RequestHead {
  std::string method;      ///< GET
  std::string target;      ///< /runs/a/report.html?x=1, still percent-encoded
  std::string host;        ///< Host
  std::string origin;      ///< Origin: the page that asks, where a browser says so
  std::string cookie;      ///< Cookie
  std::string fetch_site;  ///< Sec-Fetch-Site: how the page that asks is related to this server
  std::string fetch_mode;  ///< Sec-Fetch-Mode: `navigate` where an address is opened
  std::string range;       ///< Range
  bool upgrade = false;    ///< asks for a WebSocket
};

}  // namespace lodestone::console
