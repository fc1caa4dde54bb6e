# Installs the library, its modules, the C interface with its header and Python module, the program, and what finds them
# again: a CMake package and pkg-config files.
include(CMakePackageConfigHelpers)

set(_package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/amontons")
set(_module_dir "${CMAKE_INSTALL_INCLUDEDIR}/amontons")

install(TARGETS amontons EXPORT amontonsTargets)
install(TARGETS amontons_app)
install(DIRECTORY "$<TARGET_PROPERTY:amontons,Fortran_MODULE_DIRECTORY>/" DESTINATION "${_module_dir}"
  FILES_MATCHING PATTERN "*.mod")
install(FILES "${PROJECT_SOURCE_DIR}/doc/amontons.1" DESTINATION "${CMAKE_INSTALL_MANDIR}/man1")
install(FILES "${PROJECT_SOURCE_DIR}/scripts/amontons.bash" RENAME amontons
  DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions")
install(EXPORT amontonsTargets NAMESPACE amontons:: DESTINATION "${_package_dir}")
if(AMONTONS_SHARED)
  install(TARGETS amontons_c EXPORT amontons_cTargets)
  install(EXPORT amontons_cTargets NAMESPACE amontons:: DESTINATION "${_package_dir}")
  install(FILES "${PROJECT_SOURCE_DIR}/src/binding/amontons.h" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
  # The module looks for the library one folder up.
  install(FILES "${PROJECT_SOURCE_DIR}/python/amontons.py" DESTINATION "${CMAKE_INSTALL_LIBDIR}/amontons")
endif()

configure_package_config_file("${CMAKE_CURRENT_LIST_DIR}/amontonsConfig.cmake.in"
  "${CMAKE_CURRENT_BINARY_DIR}/amontonsConfig.cmake" INSTALL_DESTINATION "${_package_dir}")
write_basic_package_version_file("${CMAKE_CURRENT_BINARY_DIR}/amontonsConfigVersion.cmake"
  COMPATIBILITY SameMinorVersion)
install(FILES
  "${CMAKE_CURRENT_BINARY_DIR}/amontonsConfig.cmake"
  "${CMAKE_CURRENT_BINARY_DIR}/amontonsConfigVersion.cmake"
  DESTINATION "${_package_dir}")
if(AMONTONS_SUITESPARSE)
  install(FILES
    "${CMAKE_CURRENT_LIST_DIR}/FindCHOLMOD.cmake"
    "${CMAKE_CURRENT_LIST_DIR}/FindUMFPACK.cmake"
    DESTINATION "${_package_dir}")
endif()

# The library is static, so the pkg-config file names everything below it. Full paths become -L and -l, since CMake's
# reader of such files would put a path before the library on the link line.
set(AMONTONS_LINK_LINE "")
set(_libraries ${LAPACK_LIBRARIES})
if(AMONTONS_SUITESPARSE)
  list(PREPEND _libraries ${UMFPACK_LIBRARY} ${CHOLMOD_LIBRARY} ${CAMD_LIBRARY} ${SUITESPARSECONFIG_LIBRARY})
endif()
if(AMONTONS_HAS_HDF5)
  list(APPEND _libraries ${HDF5_Fortran_LIBRARIES})
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
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/amontons.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig")
if(AMONTONS_SHARED)
  configure_file("${CMAKE_CURRENT_LIST_DIR}/amontons_c.pc.in" "${CMAKE_CURRENT_BINARY_DIR}/amontons_c.pc" @ONLY)
  install(FILES "${CMAKE_CURRENT_BINARY_DIR}/amontons_c.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig")
endif()
