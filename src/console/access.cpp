#include "lodestone/console/access.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <openssl/crypto.h>
#include <openssl/rand.h>

#include <algorithm>
#include <array>

#include "lodestone/common/error.h"

namespace lodestone::console {

namespace {

constexpr std::size_t kTokenDigits = 32;
constexpr const char* kCookie = "lodestone=";
constexpr const char* kTokenQuery = "/?token=";

struct Authority {
  std::string name;
  std::string port;  // empty: that of the scheme
};

std::string in_lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return text;
}

bool is_made_of(const std::string& text, const char* characters) {
  return text.find_first_not_of(characters) == std::string::npos;
}

/// NAME, NAME:PORT, [ADDRESS] or [ADDRESS]:PORT; nothing where it is none of them.
std::optional<Authority> parse_authority(const std::string& text) {
  const bool bracketed = !text.empty() && text[0] == '[';
  const std::size_t end = bracketed ? text.find(']') : std::min(text.find(':'), text.size());
  if (end == std::string::npos || end == (bracketed ? 1 : 0)) return std::nullopt;
  Authority authority{in_lower_case(text.substr(0, end + (bracketed ? 1 : 0))),
                      text.substr(end + (bracketed ? 1 : 0))};
  if (!is_made_of(bracketed ? authority.name.substr(1, end - 1) : authority.name,
                  bracketed ? "0123456789abcdef:." : "abcdefghijklmnopqrstuvwxyz0123456789.-_"))
    return std::nullopt;
  if (authority.port.empty()) return authority;
  authority.port.erase(0, 1);
  if (text[end + (bracketed ? 1 : 0)] != ':' || authority.port.empty() || authority.port.size() > 5 ||
      !is_made_of(authority.port, "0123456789"))
    return std::nullopt;
  return authority;
}

bool is_this_machine(const Authority& authority) {
  return authority.name == "localhost" || authority.name == "127.0.0.1" || authority.name == "[::1]";
}

/// Whether a page of `origin` is one of `host`.
bool is_origin_of(const std::string& origin, const Authority& host) {
  for (const auto& [scheme, port] : {std::pair{"http://", "80"}, std::pair{"https://", "443"}}) {
    if (origin.rfind(scheme, 0) != 0) continue;
    const std::optional<Authority> from = parse_authority(origin.substr(std::string(scheme).size()));
    return from && from->name == host.name &&
           (from->port.empty() ? port : from->port) == (host.port.empty() ? port : host.port);
  }
  return false;
}

bool opens_front_door(const RequestHead& head) {
  return head.fetch_mode == "navigate" && !head.upgrade &&
         (head.target == "/" || head.target.rfind("/?", 0) == 0);
}

}  // namespace

bool is_loopback(const std::string& address) {
  if (address == "localhost") return true;
  in_addr v4{};
  if (inet_pton(AF_INET, address.c_str(), &v4) == 1) return ntohl(v4.s_addr) >> 24U == 127;
  in6_addr v6{};
  return inet_pton(AF_INET6, address.c_str(), &v6) == 1 && IN6_IS_ADDR_LOOPBACK(&v6);
}

std::string draw_token() {
  std::array<unsigned char, kTokenDigits / 2> bytes{};
  LODESTONE_CHECK(RAND_bytes(bytes.data(), static_cast<int>(bytes.size())) == 1,
                  "the system has no random numbers");
  std::string token;
  for (const unsigned char byte : bytes) token += fmt::format("{:02x}", byte);
  return token;
}

Access::Access(bool beyond_loopback, std::string token)
    : beyond_loopback_(beyond_loopback), token_(std::move(token)) {
  LODESTONE_CHECK(beyond_loopback ? token_.size() == kTokenDigits && is_made_of(token_, "0123456789abcdef")
                                  : token_.empty(),
                  fmt::format("a token of {} digits; beyond the loopback it has {}, else 0", token_.size(),
                              kTokenDigits));
}

std::optional<Response> Access::judge(const RequestHead& head) const {
  if (head.method != "GET" && head.method != "HEAD") {
    Response refusal = told(405, "this server knows GET and HEAD");
    refusal.headers.push_back({"Allow", "GET, HEAD"});
    return refusal;
  }
  if (head.target.empty() || head.target[0] != '/') return told(400, "what is asked for has to begin with /");
  if (std::optional<Response> refusal = judge_page(head)) return refusal;
  if (!beyond_loopback_) return std::nullopt;
  if (!head.upgrade && head.target.rfind(kTokenQuery, 0) == 0) {
    if (!is_token(head.target.substr(std::string(kTokenQuery).size())))
      return told(403, "not the token of this console: open the address that it printed at its start");
    Response in = told(303, "come in");
    in.headers = {{"Location", "/"},
                  {"Set-Cookie", kCookie + token_ + "; HttpOnly; SameSite=Strict; Path=/"}};
    return in;
  }
  if (has_cookie(head.cookie)) return std::nullopt;
  return told(403, "open the address that the console printed at its start: it has the token");
}

/// Whose page asks.
std::optional<Response> Access::judge_page(const RequestHead& head) const {
  const std::optional<Authority> host = parse_authority(head.host);
  if (!host) return told(400, "a request needs a Host");
  if (!beyond_loopback_ && !is_this_machine(*host))
    return told(403, "this console is only reached as localhost, 127.0.0.1 or [::1]");
  if (!head.origin.empty() && !is_origin_of(head.origin, *host))
    return told(403, "pages of other sites may not ask this console");
  if (!head.fetch_site.empty() && head.fetch_site != "same-origin" && head.fetch_site != "none" &&
      !opens_front_door(head))
    return told(403, "pages of other sites may not ask this console");
  return std::nullopt;
}

bool Access::is_token(const std::string& given) const {
  return given.size() == token_.size() && CRYPTO_memcmp(given.data(), token_.data(), token_.size()) == 0;
}

bool Access::has_cookie(const std::string& cookies) const {
  for (std::size_t at = 0; at < cookies.size();) {
    const std::size_t first = std::min(cookies.find_first_not_of(' ', at), cookies.size());
    const std::size_t end = std::min(cookies.find(';', first), cookies.size());
    const std::string cookie = cookies.substr(first, end - first);
    if (cookie.rfind(kCookie, 0) == 0 && is_token(cookie.substr(std::string(kCookie).size()))) return true;
    at = end + 1;
  }
  return false;
}

}  // namespace lodestone::console
