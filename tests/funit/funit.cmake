# A stand-in for pFUnit: the library `funit` and the function `add_pfunit_ctest` of the same names and with the same
# verdicts. Include this only where pFUnit is not found. README.md says what a .pf file may contain.
find_package(Python3 REQUIRED COMPONENTS Interpreter)

set(_funit "${CMAKE_CURRENT_LIST_DIR}")
add_library(funit STATIC
  "${_funit}/funit.f90"
  "${_funit}/funit_condition.f90"
  "${_funit}/funit_equality.f90"
  "${_funit}/funit_exception.f90"
  "${_funit}/funit_order.f90"
  "${_funit}/funit_pair.f90"
  "${_funit}/funit_relation.f90"
  "${_funit}/funit_runner.f90"
  "${_funit}/funit_text.f90")
set_target_properties(funit PROPERTIES Fortran_MODULE_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}/funit.dir")
target_include_directories(funit INTERFACE "${CMAKE_CURRENT_BINARY_DIR}/funit.dir")

# add_pfunit_ctest(name TEST_SOURCES a.pf ... [OTHER_SOURCES ...] [LINK_LIBRARIES ...] [LABELS ...]
#                  [WORKING_DIRECTORY dir])
# Builds one executable from the test files and makes it the ctest test `name`.
function(add_pfunit_ctest name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "WORKING_DIRECTORY" "TEST_SOURCES;OTHER_SOURCES;LINK_LIBRARIES;LABELS")
  if(arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "add_pfunit_ctest(${name}): outside the subset: ${arg_UNPARSED_ARGUMENTS}")
  endif()
  if(NOT arg_TEST_SOURCES)
    message(FATAL_ERROR "add_pfunit_ctest(${name}): TEST_SOURCES is missing")
  endif()

  set(directory "${CMAKE_CURRENT_BINARY_DIR}/${name}.dir")
  set(generated "")
  set(uses "")
  set(calls "")
  foreach(source IN LISTS arg_TEST_SOURCES)
    _funit_claim("${source}")
    cmake_path(GET source STEM suite)
    set(input "${CMAKE_CURRENT_SOURCE_DIR}/${source}")
    set(output "${directory}/${suite}.F90")
    if(output IN_LIST generated)
      message(FATAL_ERROR "add_pfunit_ctest(${name}): two test files are named ${suite}.pf")
    endif()
    add_custom_command(
      OUTPUT "${output}"
      COMMAND Python3::Interpreter "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/funit_preprocess.py" "${input}" "${output}"
      DEPENDS "${input}" "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/funit_preprocess.py"
      COMMENT "Preprocessing ${source}"
      VERBATIM)
    list(APPEND generated "${output}")
    list(APPEND uses "use wrap${suite}, only: ${suite}_suite")
    list(APPEND calls "call ${suite}_suite(runner)")
  endforeach()
  list(JOIN uses "\n   " uses)
  list(JOIN calls "\n   " calls)
  configure_file("${CMAKE_CURRENT_FUNCTION_LIST_DIR}/driver.f90.in" "${directory}/driver.f90" @ONLY)

  add_executable(${name} ${generated} "${directory}/driver.f90" ${arg_OTHER_SOURCES})
  set_target_properties(${name} PROPERTIES Fortran_MODULE_DIRECTORY "${directory}")
  # Without a keyword, as pFUnit does it: a later call with one is an error here too.
  target_link_libraries(${name} funit ${arg_LINK_LIBRARIES})
  if(NOT arg_WORKING_DIRECTORY)
    set(arg_WORKING_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}")
  endif()
  add_test(NAME ${name} COMMAND ${name} WORKING_DIRECTORY "${arg_WORKING_DIRECTORY}")
  set_tests_properties(${name} PROPERTIES LABELS "${arg_LABELS}")
endfunction()

# Refuses what pFUnit would build in the wrong place or twice in the same place.
function(_funit_claim source)
  if(IS_ABSOLUTE "${source}")
    message(FATAL_ERROR "add_pfunit_ctest: ${source} must be relative to the source directory")
  endif()
  get_property(claimed DIRECTORY PROPERTY FUNIT_SOURCES)
  if(source IN_LIST claimed)
    message(FATAL_ERROR "add_pfunit_ctest: ${source} is a source of another executable of this directory")
  endif()
  set_property(DIRECTORY APPEND PROPERTY FUNIT_SOURCES "${source}")
endfunction()
