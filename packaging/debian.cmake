# Debian packages, one a component: lodestone (program, presets, models, firmware), liblodestone-dev (headers, static
# libraries), and python3-lodestone where the Python package is built. `cpack` in a build folder makes them, and
# scripts/package tries them in a bare Debian.
set(package_runtime lodestone)
set(package_dev liblodestone-dev)
set(package_python python3-lodestone)

set(what "learns a simulator of a magnetic rig, trains a controller in it, drives the rig")
set(CPACK_DEBIAN_RUNTIME_DESCRIPTION "${what}
 Program, presets and released models. A rig is four coils and a camera over a dish, or the virtual one inside.
 Nothing here is a medical device.")
set(CPACK_DEBIAN_DEV_DESCRIPTION "${what} (C++ library)
 Headers and static libraries for find_package(lodestone). What learns also needs libtorch-dev.")
set(CPACK_DEBIAN_PYTHON_DESCRIPTION "${what} (Python)
 The package lodestone for Debian's own python3: environments, policies, recordings.")

set(CPACK_DEBIAN_RUNTIME_PACKAGE_SECTION science)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)

# Shared libraries are found by dpkg-shlibdeps. Beside them: a BLAS that is not the slow reference one, which LibTorch
# is content with, and what static libraries leave to who links them.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_DEPENDS libopenblas0-pthread)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_RECOMMENDS "ninja-build, xdg-utils, gnuplot-nox, librsvg2-bin")  # plans; the console's page; figures
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SUGGESTS slurm-client)
file(STRINGS ${PROJECT_SOURCE_DIR}/third_party/packages.apt libraries REGEX "-dev$")
# Left out: LibTorch, which is recommended, and what only the program or the package of Python is built with.
list(REMOVE_ITEM libraries libtorch-dev libcli11-dev libsdl2-dev pybind11-dev python3-dev)
list(JOIN libraries ", " CPACK_DEBIAN_DEV_PACKAGE_DEPENDS)
set(CPACK_DEBIAN_DEV_PACKAGE_RECOMMENDS libtorch-dev)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3, python3-numpy")
set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS lodestone)  # its models

get_cmake_property(CPACK_COMPONENTS_ALL COMPONENTS)
foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package_${component}}
          RENAME copyright COMPONENT ${component})
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${package_${component}})
endforeach()

set(CPACK_GENERATOR DEB)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_OUTPUT_FILE_PREFIX ${PROJECT_BINARY_DIR}/packages)
set(CPACK_PACKAGE_CONTACT "The Lodestone maintainers <maintainers@lodestone.invalid>")
set(CPACK_STRIP_FILES ON)
set(CPACK_THREADS 0)
include(CPack)
