# One place that says how a module is built.
include_guard(GLOBAL)

# Warnings and sanitizers, per target: nothing is set globally.
add_library(lodestone_build_flags INTERFACE)
target_compile_options(lodestone_build_flags INTERFACE -Wall -Wextra -Wshadow -Wno-unused-parameter
                       -ffp-contract=off $<$<BOOL:${LODESTONE_WERROR}>:-Werror>)
if(LODESTONE_SANITIZE)
  target_compile_options(lodestone_build_flags INTERFACE -fsanitize=${LODESTONE_SANITIZE}
                         -fno-omit-frame-pointer -fno-sanitize-recover=undefined)
  target_link_options(lodestone_build_flags INTERFACE -fsanitize=${LODESTONE_SANITIZE})
endif()

# lodestone_module(NAME SOURCES a.cpp... DEPENDS common geometry... LIBRARIES external... [TORCH])
# makes the static library lodestone_NAME, alias lodestone::NAME. Header-only modules list no sources.
function(lodestone_module name)
  cmake_parse_arguments(ARG "TORCH" "" "SOURCES;DEPENDS;LIBRARIES;PRIVATE_LIBRARIES" ${ARGN})
  set(target lodestone_${name})
  file(GLOB present RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} CONFIGURE_DEPENDS *.cpp)  # SCAFFOLD
  foreach(source IN LISTS ARG_SOURCES)  # SCAFFOLD
    if(NOT EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/${source} AND NOT IS_ABSOLUTE ${source})  # SCAFFOLD
      message(STATUS "${name}: ${source} is not there yet")  # SCAFFOLD
      list(REMOVE_ITEM ARG_SOURCES ${source})  # SCAFFOLD
    endif()  # SCAFFOLD
  endforeach()  # SCAFFOLD
  if(ARG_SOURCES)
    add_library(${target} STATIC ${ARG_SOURCES})
    set(scope PUBLIC)
    target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:lodestone_build_flags> ${ARG_PRIVATE_LIBRARIES})
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  else()
    add_library(${target} INTERFACE)
    set(scope INTERFACE)
  endif()
  add_library(lodestone::${name} ALIAS ${target})
  target_compile_features(${target} ${scope} cxx_std_17)
  target_include_directories(${target} ${scope} $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
                             $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  foreach(dependency IN LISTS ARG_DEPENDS)
    if(TARGET lodestone::${dependency})  # SCAFFOLD
    target_link_libraries(${target} ${scope} lodestone::${dependency})
    endif()  # SCAFFOLD
  endforeach()
  target_link_libraries(${target} ${scope} ${ARG_LIBRARIES})
  if(ARG_TORCH)
    target_link_libraries(${target} ${scope} ${TORCH_LIBRARIES})
    if(ARG_SOURCES)
      lodestone_use_torch_pch(${target})
    endif()
  endif()
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  install(TARGETS ${target} EXPORT lodestone-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
endfunction()

# LibTorch's headers dominate the build time: one precompiled header serves every target that uses them.
function(lodestone_use_torch_pch target)
  get_target_property(kind ${target} TYPE)
  if(NOT TARGET lodestone_torch_pch)
    file(GENERATE OUTPUT ${PROJECT_BINARY_DIR}/torch_pch.cpp CONTENT "")
    add_library(lodestone_torch_pch OBJECT ${PROJECT_BINARY_DIR}/torch_pch.cpp)
    target_link_libraries(lodestone_torch_pch PRIVATE lodestone_build_flags ${TORCH_LIBRARIES})
    set_target_properties(lodestone_torch_pch PROPERTIES POSITION_INDEPENDENT_CODE ON)
    target_precompile_headers(lodestone_torch_pch PRIVATE <torch/torch.h>)
  endif()
  if(kind STREQUAL "EXECUTABLE")  # -fPIE, CMake's choice for programs, would not match the header's -fPIC
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE OFF)
    target_compile_options(${target} PRIVATE -fPIC)
  endif()
  target_precompile_headers(${target} REUSE_FROM lodestone_torch_pch)
endfunction()
