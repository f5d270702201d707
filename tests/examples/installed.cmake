# Installs the build tree into a scratch prefix, and builds the examples as a project of their own against it: all of
# them in a soak, else one without LibTorch and one that drives a rig.
include(${CMAKE_CURRENT_LIST_DIR}/../installed_tree.cmake)

install_tree()
run("${CMAKE_COMMAND}" -G Ninja -S ${SOURCE} -B ${SCRATCH}/build -DCMAKE_PREFIX_PATH=${SCRATCH}/prefix -DCMAKE_BUILD_TYPE=Release)
set(programs load_policy own_coils)
if(DEFINED ENV{LODESTONE_SOAK})
  file(GLOB programs RELATIVE ${SOURCE} ${SOURCE}/*.cpp)
  list(TRANSFORM programs REPLACE "[.]cpp$" "")
endif()
run("${CMAKE_COMMAND}" --build ${SCRATCH}/build --target ${programs})

# What one says is what the one of the tree says.
foreach(program IN LISTS programs)
  if(NOT EXISTS ${SCRATCH}/build/${program})
    message(FATAL_ERROR "${program} was not built")
  endif()
endforeach()
foreach(program ${SCRATCH}/build/load_policy ${IN_TREE})
  run(${program} ${MODELS}/centre 0.010 0.020 0.1 0 0)
  list(APPEND said "${output}")
endforeach()
list(REMOVE_DUPLICATES said)
list(LENGTH said count)
if(NOT count EQUAL 1 OR NOT said MATCHES "coil -y [0-9.]+ A")
  message(FATAL_ERROR "they differ: ${said}")
endif()
message(STATUS "${said}")
