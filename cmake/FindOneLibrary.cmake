# find_one_library(name header library others...): the package NAME of a header, a library and others that it is linked
# with, found where compilers look, and in the folder of SuiteSparse. Defines the imported target NAME::NAME.
include(FindPackageHandleStandardArgs)

macro(find_one_library name header library)
  find_path(${name}_INCLUDE_DIR ${header} PATH_SUFFIXES suitesparse)
  find_library(${name}_LIBRARY ${library})
  set(libraries ${name}_LIBRARY)
  set(linked)
  foreach(other ${ARGN})
    string(TOUPPER ${other}_LIBRARY variable)
    find_library(${variable} ${other})
    list(APPEND libraries ${variable})
    list(APPEND linked "${${variable}}")
  endforeach()
  find_package_handle_standard_args(${name} REQUIRED_VARS ${libraries} ${name}_INCLUDE_DIR)

  if(${name}_FOUND AND NOT TARGET ${name}::${name})
    add_library(${name}::${name} UNKNOWN IMPORTED)
    set_target_properties(${name}::${name} PROPERTIES
      IMPORTED_LOCATION "${${name}_LIBRARY}"
      INTERFACE_INCLUDE_DIRECTORIES "${${name}_INCLUDE_DIR}"
      INTERFACE_LINK_LIBRARIES "${linked}")
  endif()
  mark_as_advanced(${name}_INCLUDE_DIR ${libraries})
endmacro()
