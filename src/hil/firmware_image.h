#pragma once

#include <cstddef>
#include <cstdint>

namespace lodestone::hil {

/// firmware/coils as the build compiled it.
extern const std::uint8_t* const kFirmwareImage;
extern const std::size_t kFirmwareImageSize;

}  // namespace lodestone::hil
