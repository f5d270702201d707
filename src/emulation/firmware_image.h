#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace lodestone::emulation {

struct FirmwareImage {
  const std::uint8_t* bytes;
  std::size_t size;
};

constexpr std::size_t kFirmwareImages = 8;

/// firmware/coils as the build compiled it for 1, 2, ... motor controllers.
extern const std::array<FirmwareImage, kFirmwareImages> kFirmware;

}  // namespace lodestone::emulation
