# The tests' Python is the system's, where there is one: meshio and VTK are its packages.
if(NOT DEFINED Python3_EXECUTABLE AND EXISTS /usr/bin/python3)
  set(Python3_EXECUTABLE /usr/bin/python3)
endif()

# Unit tests: on pFUnit where it is installed, else on the stand-in in tests/funit. Both run the same .pf files.
find_package(PFUNIT 4.4 QUIET)
set(has_unit_tests ON)
if(NOT PFUNIT_FOUND AND CMAKE_Fortran_COMPILER_ID STREQUAL "LLVMFlang"
   AND CMAKE_Fortran_COMPILER_VERSION VERSION_LESS 22)
  message(STATUS "No unit tests: flang ${CMAKE_Fortran_COMPILER_VERSION} cannot compile arguments of assumed rank")
  set(has_unit_tests OFF)
endif()

# Flags of test executables. pFUnit generates code that is not ours, so there warnings are shown and not enforced:
# this must come after the project's flags.
add_library(amontons_test_flags INTERFACE)

# What is optimized, or contracted, is the library: the compiler would take three times as long over the tests.
target_compile_options(amontons_test_flags INTERFACE -O0)

if(PFUNIT_FOUND)
  message(STATUS "Unit tests run on pFUnit ${PFUNIT_VERSION}")
  target_compile_options(amontons_test_flags INTERFACE -Wno-error)
elseif(has_unit_tests)
  message(STATUS "Unit tests run on the stand-in for pFUnit in tests/funit (pFUnit 4.4 was not found)")
  include("${PROJECT_SOURCE_DIR}/tests/funit/funit.cmake")
  target_link_libraries(funit PRIVATE amontons_flags)
endif()

# Makes a ctest test pass only if unit tests ran and all of them passed. The exit status alone would not tell: it is
# also 0 where the code under test executes `stop`, and where no test ran at all.
set(passed_tests " OK\n \\([1-9][0-9]* tests?(, [0-9]+ disabled)?\\)\n")
function(require_passed_tests name)
  set_property(TEST ${name} PROPERTY PASS_REGULAR_EXPRESSION "${passed_tests}")
endfunction()

# By how much counters and sanitizers may slow a test down; the tests of the contact methods need most of it.
set(slowness 1)
if(AMONTONS_SANITIZE OR AMONTONS_COVERAGE)
  set(slowness 8)
endif()

# add_unit_test(name SOURCES a.pf b.pf ... [LINK_LIBRARIES ...] [LABELS ...] [OTHER_SOURCES ...]
#               [WORKING_DIRECTORY dir])
# One executable and ctest test from the given test files, on the library. Sources are relative to the directory of
# the calling CMakeLists.txt and belong to one executable only; every library is named in LINK_LIBRARIES. The cases are
# small and tests run side by side: with one thread each, none waits for the threads of another.
function(add_unit_test name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;LINK_LIBRARIES;LABELS;OTHER_SOURCES;WORKING_DIRECTORY")
  # Each test writes its files in a folder of its own, so that tests can run side by side.
  if(NOT arg_WORKING_DIRECTORY)
    set(arg_WORKING_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}/${name}.run")
    file(MAKE_DIRECTORY "${arg_WORKING_DIRECTORY}")
  endif()
  set(optional "")
  foreach(keyword IN ITEMS OTHER_SOURCES WORKING_DIRECTORY)
    if(arg_${keyword})
      list(APPEND optional ${keyword} ${arg_${keyword}})
    endif()
  endforeach()
  add_pfunit_ctest(${name}
    TEST_SOURCES ${arg_SOURCES}
    LINK_LIBRARIES amontons_flags amontons_test_flags amontons::amontons ${arg_LINK_LIBRARIES}
    LABELS unit ${arg_LABELS}
    ${optional} ${arg_UNPARSED_ARGUMENTS})
  require_passed_tests(${name})
  math(EXPR seconds "600*${slowness}")
  set_tests_properties(${name} PROPERTIES TIMEOUT ${seconds} ENVIRONMENT "OMP_NUM_THREADS=1;OPENBLAS_NUM_THREADS=1")
endfunction()
