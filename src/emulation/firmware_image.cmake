# cmake -DFOLDER=that of coils-1.bin to coils-8.bin -DOUT=firmware_image.cpp -P firmware_image.cmake
set(images "")
set(table "")
foreach(controllers RANGE 1 8)
  file(READ ${FOLDER}/coils-${controllers}.bin hex HEX)
  string(REGEX REPLACE "(..)" "0x\\1," bytes "${hex}")
  string(APPEND images "const std::uint8_t image_${controllers}[] = {${bytes}};\n")
  string(APPEND table "{image_${controllers}, sizeof image_${controllers}},")
endforeach()
file(WRITE ${OUT} "#include \"firmware_image.h\"
namespace lodestone::emulation {
namespace {
${images}}
const std::array<FirmwareImage, kFirmwareImages> kFirmware = {{${table}}};
}
")
