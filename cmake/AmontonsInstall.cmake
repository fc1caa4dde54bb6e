# Installs, as the component runtime the program and the C library, as devel what programs are built with: the library,
# its modules, the C header, a CMake package and pkg-config files; as python the package amontons and its commands.
include(CMakePackageConfigHelpers)

set(AMONTONS_PYTHON_DIR "${CMAKE_INSTALL_LIBDIR}/amontons" CACHE STRING
  "Folder that the Python package is installed in, below the prefix")
set(AMONTONS_PYTHON "/usr/bin/env python3" CACHE STRING "Python of amontons-plot and its like, as after #!")

set(_package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/amontons")
set(_module_dir "${CMAKE_INSTALL_INCLUDEDIR}/amontons")

install(TARGETS amontons EXPORT amontonsTargets COMPONENT devel)
install(TARGETS amontons_app COMPONENT runtime)
install(DIRECTORY "$<TARGET_PROPERTY:amontons,Fortran_MODULE_DIRECTORY>/" DESTINATION "${_module_dir}"
  COMPONENT devel FILES_MATCHING PATTERN "*.mod")
install(FILES "${PROJECT_SOURCE_DIR}/doc/amontons.1" DESTINATION "${CMAKE_INSTALL_MANDIR}/man1" COMPONENT runtime)
install(FILES "${PROJECT_SOURCE_DIR}/doc/amontons.bash" RENAME amontons
  DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions" COMPONENT runtime)
install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT runtime)
install(EXPORT amontonsTargets NAMESPACE amontons:: DESTINATION "${_package_dir}" COMPONENT devel)
if(AMONTONS_SHARED)
  install(TARGETS amontons_c EXPORT amontons_cTargets
    LIBRARY COMPONENT runtime NAMELINK_COMPONENT devel)
  install(EXPORT amontons_cTargets NAMESPACE amontons:: DESTINATION "${_package_dir}" COMPONENT devel)
  install(FILES "${PROJECT_SOURCE_DIR}/src/binding/amontons.h" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}"
    COMPONENT devel)
  install(DIRECTORY "${PROJECT_SOURCE_DIR}/python/amontons" DESTINATION "${AMONTONS_PYTHON_DIR}" COMPONENT python
    PATTERN "__pycache__" EXCLUDE)
  cmake_path(ABSOLUTE_PATH AMONTONS_PYTHON_DIR BASE_DIRECTORY "${CMAKE_INSTALL_PREFIX}" OUTPUT_VARIABLE _python_dir)
  file(RELATIVE_PATH AMONTONS_PYTHON_FROM_BIN "${CMAKE_INSTALL_FULL_BINDIR}" "${_python_dir}")
  foreach(AMONTONS_COMMAND IN ITEMS plot report adapt)
    configure_file("${CMAKE_CURRENT_LIST_DIR}/command.py.in" "commands/amontons-${AMONTONS_COMMAND}" @ONLY)
    install(PROGRAMS "${CMAKE_CURRENT_BINARY_DIR}/commands/amontons-${AMONTONS_COMMAND}" TYPE BIN COMPONENT python)
  endforeach()
endif()

configure_package_config_file("${CMAKE_CURRENT_LIST_DIR}/amontonsConfig.cmake.in"
  "${CMAKE_CURRENT_BINARY_DIR}/amontonsConfig.cmake" INSTALL_DESTINATION "${_package_dir}")
write_basic_package_version_file("${CMAKE_CURRENT_BINARY_DIR}/amontonsConfigVersion.cmake"
  COMPATIBILITY SameMinorVersion)
install(FILES
  "${CMAKE_CURRENT_BINARY_DIR}/amontonsConfig.cmake"
  "${CMAKE_CURRENT_BINARY_DIR}/amontonsConfigVersion.cmake"
  DESTINATION "${_package_dir}" COMPONENT devel)
if(AMONTONS_SUITESPARSE)
  install(FILES
    "${CMAKE_CURRENT_LIST_DIR}/FindCHOLMOD.cmake"
    "${CMAKE_CURRENT_LIST_DIR}/FindOneLibrary.cmake"
    "${CMAKE_CURRENT_LIST_DIR}/FindUMFPACK.cmake"
    DESTINATION "${_package_dir}" COMPONENT devel)
endif()

# The library is static, so the pkg-config file names everything below it. Full paths become -L and -l, since CMake's
# reader of such files would put a path before the library on the link line.
set(AMONTONS_LINK_LINE "")
set(_libraries ${LAPACK_LIBRARIES})
if(AMONTONS_SUITESPARSE)
  list(PREPEND _libraries ${UMFPACK_LIBRARY} ${CHOLMOD_LIBRARY} ${CAMD_LIBRARY} ${SUITESPARSECONFIG_LIBRARY})
endif()
foreach(_library IN LISTS _libraries)
  if(IS_ABSOLUTE "${_library}")
    cmake_path(GET _library PARENT_PATH _directory)
    cmake_path(GET _library STEM _name)
    string(REGEX REPLACE "^lib" "-L${_directory} -l" _library "${_name}")
  endif()
  string(APPEND AMONTONS_LINK_LINE " ${_library}")
endforeach()
file(RELATIVE_PATH AMONTONS_PREFIX_FROM_PC
  "${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig" "${CMAKE_INSTALL_PREFIX}")
configure_file("${CMAKE_CURRENT_LIST_DIR}/amontons.pc.in" "${CMAKE_CURRENT_BINARY_DIR}/amontons.pc" @ONLY)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/amontons.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig" COMPONENT devel)
if(AMONTONS_SHARED)
  configure_file("${CMAKE_CURRENT_LIST_DIR}/amontons_c.pc.in" "${CMAKE_CURRENT_BINARY_DIR}/amontons_c.pc" @ONLY)
  install(FILES "${CMAKE_CURRENT_BINARY_DIR}/amontons_c.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig"
    COMPONENT devel)
endif()
