# Compiler flags of the project, on an interface target that only its own targets link.
add_library(amontons_flags INTERFACE)

set(_gfortran "$<COMPILE_LANG_AND_ID:Fortran,GNU>")
set(_flang "$<COMPILE_LANG_AND_ID:Fortran,LLVMFlang>")
set(_c "$<COMPILE_LANGUAGE:C>")
set(_debug "$<CONFIG:Debug>")
# A failing check ends the program, which the counters would show as a call that no test made.
set(_checked "$<AND:${_debug},$<NOT:$<BOOL:${AMONTONS_COVERAGE}>>>")

target_compile_options(amontons_flags INTERFACE
  "$<${_gfortran}:-std=f2018;-pedantic;-ffree-line-length-132;-fimplicit-none>"
  # flang's -std warns of standard Fortran that other compilers may lack.
  "$<${_flang}:-Werror>"
  "$<${_gfortran}:-Wall;-Wextra;-Wimplicit-interface;-Wimplicit-procedure;-Werror>"
  # gfortran 12 takes the descriptor of an allocatable for uninitialized when it is first allocated by assignment.
  "$<${_gfortran}:-Wno-maybe-uninitialized;-Wno-uninitialized>"
  # The shared library is made of the same objects: none of its procedures is replaced from outside.
  "$<$<OR:${_gfortran},${_c}>:-fno-semantic-interposition>"
  "$<${_c}:-std=c11;-Wall;-Wextra;-pedantic;-Werror>"
  "$<${_debug}:-g;-O0>"
  # CMake gives flang no flags of its own for a release.
  "$<$<AND:${_flang},$<CONFIG:Release>>:-O2>"
  "$<$<AND:${_gfortran},${_checked}>:-fcheck=all,no-array-temps;-finit-real=snan;-fbacktrace>")

# No source needs a preprocessor, which takes its time for each, and that of flang 19 writes every backslash twice. A
# release by gfortran is preprocessed for the sake of names, see below.
if(CMAKE_Fortran_COMPILER_ID STREQUAL "LLVMFlang" OR NOT CMAKE_BUILD_TYPE STREQUAL "Release")
  set(CMAKE_Fortran_PREPROCESS OFF)
endif()

# Two builds of the same sources are the same to the last bit, wherever they lie: gfortran would put the full name of
# the source file into the messages of its run-time library and into the module files. With -g, debuggers need it. Only
# the file's own name is left: gfortran looks for the folder before it.
if(CMAKE_BUILD_TYPE STREQUAL "Release" AND CMAKE_Fortran_COMPILER_ID STREQUAL "GNU")
  string(APPEND CMAKE_Fortran_PREPROCESS_SOURCE
    " && sed -i 's,^\\(# [0-9]* \\\"\\)[^\\\"]*/,\\1,' <PREPROCESSED_SOURCE>")
endif()

# Undefined behavior ends the program, except for overflows: where an array that is not allocated yet is assigned,
# gfortran computes with bounds that it never uses.
if(AMONTONS_SANITIZE)
  target_compile_options(amontons_flags INTERFACE -fsanitize=address,undefined -fno-sanitize-recover=undefined
    -fsanitize-recover=signed-integer-overflow -fno-omit-frame-pointer)
  target_link_options(amontons_flags INTERFACE -fsanitize=address,undefined)
endif()
if(AMONTONS_COVERAGE)
  target_compile_options(amontons_flags INTERFACE --coverage)
  target_link_options(amontons_flags INTERFACE --coverage)
endif()
# Contracted multiply-adds change the last digits of everything: no verdict and no test may depend on them.
if(AMONTONS_CONTRACTED)
  include(CheckCSourceRuns)
  check_c_source_runs(
    "int main(void) { return !(__builtin_cpu_supports(\"avx2\") && __builtin_cpu_supports(\"fma\")); }"
    AMONTONS_PROCESSOR_CONTRACTS)
  if(NOT AMONTONS_PROCESSOR_CONTRACTS)
    message(FATAL_ERROR "AMONTONS_CONTRACTED needs a processor with AVX2 and FMA, which this machine does not have")
  endif()
  target_compile_options(amontons_flags INTERFACE -O2 -mavx2 -mfma -ffp-contract=fast)
endif()
