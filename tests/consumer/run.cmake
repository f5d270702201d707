# Installs the build tree into a scratch prefix, then configures, builds and runs two consumers against it: one of
# every module, and one of those without LibTorch, which must not even be looked for.
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE failed OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(failed)
    message(FATAL_ERROR "${ARGN}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

function(build source folder)
  run("${CMAKE_COMMAND}" -G Ninja -S ${source} -B ${folder} -DCMAKE_PREFIX_PATH=${SCRATCH}/prefix -DCMAKE_BUILD_TYPE=Release ${ARGN})
  run("${CMAKE_COMMAND}" --build ${folder})
endfunction()

file(REMOVE_RECURSE ${SCRATCH})
run("${CMAKE_COMMAND}" --install ${BUILD} --prefix ${SCRATCH}/prefix --component runtime)
run("${CMAKE_COMMAND}" --install ${BUILD} --prefix ${SCRATCH}/prefix --component dev)

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
