# Installs the build tree into a scratch prefix, then configures, builds and runs two consumers against it: one of
# every module, and one of those without LibTorch, which must not even be looked for.
include(${CMAKE_CURRENT_LIST_DIR}/../installed_tree.cmake)

function(build source folder)
  run("${CMAKE_COMMAND}" -G Ninja -S ${source} -B ${folder} -DCMAKE_PREFIX_PATH=${SCRATCH}/prefix -DCMAKE_BUILD_TYPE=Release ${ARGN})
  run("${CMAKE_COMMAND}" --build ${folder})
endfunction()

install_tree()

build(${SOURCE} ${SCRATCH}/build)
run(${SCRATCH}/build/consumer)
message(STATUS "${output}")

build(${SOURCE}/runtime ${SCRATCH}/runtime -DCMAKE_DISABLE_FIND_PACKAGE_Torch=ON)
run(ldd ${SCRATCH}/runtime/deploy)
if(output MATCHES "lib(torch|c10)" OR NOT output MATCHES "libopencv_core")
  message(FATAL_ERROR "it links LibTorch, or was not looked at:\n${output}")
endif()
run(${SCRATCH}/runtime/deploy ${SCRATCH}/prefix/share/lodestone/models)
message(STATUS "${output}")
