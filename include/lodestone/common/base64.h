#pragma once

#include <string>
#include <string_view>

namespace lodestone::common {

/// Bytes as text for data URIs (RFC 4648, with padding).
std::string base64(std::string_view bytes);

}  // namespace lodestone::common
