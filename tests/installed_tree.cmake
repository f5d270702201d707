# What tests of an installed Lodestone share, run by cmake -P with BUILD, the build tree, and SCRATCH, a folder of the test's own.

# Runs a command that must succeed; `output` is what it said.
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE failed OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(failed)
    message(FATAL_ERROR "${ARGN}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

# Makes SCRATCH anew, with the build tree installed in SCRATCH/prefix.
function(install_tree)
  file(REMOVE_RECURSE ${SCRATCH})
  foreach(component runtime dev)
    run("${CMAKE_COMMAND}" --install ${BUILD} --prefix ${SCRATCH}/prefix --component ${component})
  endforeach()
endfunction()
