#pragma once

#include <cstddef>
#include <cstdint>

namespace lodestone::emulation {

/// firmware/coils as the build compiled it.
extern const std::uint8_t* const kFirmwareImage;
extern const std::size_t kFirmwareImageSize;

}  // namespace lodestone::emulation
