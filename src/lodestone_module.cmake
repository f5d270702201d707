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
# What links LibTorch, directly or through a module below it, is installed for the component `training` of
# find_package(lodestone), all else for `runtime`.
function(lodestone_module name)
  cmake_parse_arguments(ARG "TORCH" "" "SOURCES;DEPENDS;LIBRARIES;PRIVATE_LIBRARIES" ${ARGN})
  set(target lodestone_${name})
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
  set(component runtime)
  foreach(dependency IN LISTS ARG_DEPENDS)
    target_link_libraries(${target} ${scope} lodestone::${dependency})
    get_target_property(of_dependency lodestone_${dependency} LODESTONE_COMPONENT)
    if(of_dependency STREQUAL "training")
      set(component training)
    endif()
  endforeach()
  target_link_libraries(${target} ${scope} ${ARG_LIBRARIES})
  if(ARG_TORCH)
    target_link_libraries(${target} ${scope} ${TORCH_LIBRARIES})
    set(component training)
  endif()
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} LODESTONE_COMPONENT ${component})
  install(TARGETS ${target} EXPORT lodestone-${component}-targets
          ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev)
endfunction()
