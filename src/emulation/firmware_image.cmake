# cmake -DIN=coils.bin -DOUT=firmware_image.cpp -P firmware_image.cmake
file(READ ${IN} hex HEX)
string(REGEX REPLACE "(..)" "0x\\1," bytes "${hex}")
file(WRITE ${OUT} "#include \"firmware_image.h\"
namespace lodestone::emulation {
namespace {
const std::uint8_t image[] = {${bytes}};
}
const std::uint8_t* const kFirmwareImage = image;
const std::size_t kFirmwareImageSize = sizeof image;
}
")
