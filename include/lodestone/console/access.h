#pragma once

#include <optional>
#include <string>

#include "lodestone/console/request_head.h"
#include "lodestone/console/response.h"

namespace lodestone::console {

/// Whether only programs on this machine reach a server at this address: 127.0.0.0/8, ::1, or `localhost`.
bool is_loopback(const std::string& address);

/// 128 random bits as 32 hexadecimal digits.
std::string draw_token();

/// Who may ask. A browser shows pages of anybody and lets them send requests to this server too; so each
/// request has to be one that this server's own page, the person at the browser, or a program makes.
///
/// On the loopback `Host` has to be a name of this machine, with any port, so that neither a foreign name
/// which resolves to this machine is let in (DNS rebinding) nor a tunnel from another port kept out. Beyond
/// it, the token opens the door: `/?token=...` hands it to the browser as a cookie, and everything else needs
/// that cookie. In either case `Origin`, where there is one, has to be what `Host` says. Browsers send it
/// with every WebSocket; a program may leave it out.
class Access {
 public:
  /// `token`: as draw_token() makes it beyond the loopback, else empty.
  Access(bool beyond_loopback, std::string token);

  /// The answer that refuses, or hands out the cookie; nothing where the request is allowed.
  std::optional<Response> judge(const RequestHead& head) const;

 private:
  std::optional<Response> judge_page(const RequestHead& head) const;
  bool is_token(const std::string& given) const;
  bool has_cookie(const std::string& cookies) const;

  bool beyond_loopback_;
  std::string token_;
};

}  // namespace lodestone::console
