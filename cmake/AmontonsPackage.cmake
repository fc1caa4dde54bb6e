# Debian packages, by `cpack -G DEB` in a build folder: amontons (program and C library), libamontons-dev (what programs
# are built with), python3-amontons. scripts/deb.sh builds them for the places that Debian has for each.
set(CPACK_GENERATOR "DEB")
set(CPACK_PACKAGE_CONTACT "The Amontons developers")
set(CPACK_PACKAGE_VENDOR "The Amontons developers")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "plane contact with Coulomb friction")
set(CPACK_RESOURCE_FILE_LICENSE "${PROJECT_SOURCE_DIR}/LICENSE")
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL runtime devel python)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME "DEB-DEFAULT")
set(CPACK_DEBIAN_PACKAGE_SECTION "science")
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS OFF)

set(_same_version "(= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME "amontons")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SUGGESTS "python3-amontons, paraview")
set(CPACK_COMPONENT_RUNTIME_DESCRIPTION "program and C library
Amontons solves plane and axisymmetric contact with Coulomb friction by
finite elements: decks in, listings, tables and grids for ParaView out, every
result checked on the full model.")

set(CPACK_DEBIAN_DEVEL_PACKAGE_NAME "libamontons-dev")
set(CPACK_DEBIAN_DEVEL_PACKAGE_SECTION "libdevel")
set(_devel "amontons ${_same_version}, gfortran, libopenblas-dev")
if(AMONTONS_SUITESPARSE)
  string(APPEND _devel ", libsuitesparse-dev")
endif()
set(CPACK_DEBIAN_DEVEL_PACKAGE_DEPENDS "${_devel}")
set(CPACK_COMPONENT_DEVEL_DESCRIPTION "library for Fortran and C
The static library with its Fortran modules, the C header, and what CMake and
pkg-config find both by.")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME "python3-amontons")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION "python")
set(CPACK_DEBIAN_PYTHON_PACKAGE_ARCHITECTURE "all")
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "amontons ${_same_version}, python3 (>= 3.9), python3-numpy")
set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "python3-matplotlib")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-h5py, gmsh")
set(CPACK_COMPONENT_PYTHON_DESCRIPTION "Python package, pictures and reports
The module amontons, and the commands amontons-plot, amontons-report and
amontons-adapt.")

include(CPack)
