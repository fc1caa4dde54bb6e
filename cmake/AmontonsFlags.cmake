# Compiler flags of the project, on an interface target that only its own targets link.
add_library(amontons_flags INTERFACE)

set(_fortran "$<COMPILE_LANGUAGE:Fortran>")
set(_c "$<COMPILE_LANGUAGE:C>")
set(_debug "$<CONFIG:Debug>")

target_compile_options(amontons_flags INTERFACE
  "$<${_fortran}:-std=f2018;-ffree-line-length-132;-fimplicit-none>"
  # gfortran 12 takes the descriptor of an allocatable for uninitialised when it is first allocated by assignment.
  "$<${_fortran}:-Wall;-Wextra;-pedantic;-Wimplicit-interface;-Wimplicit-procedure;-Werror>"
  "$<${_fortran}:-Wno-maybe-uninitialized;-Wno-uninitialized>"
  # The shared library is made of the same objects: none of its procedures is replaced from outside.
  "-fno-semantic-interposition"
  "$<${_c}:-std=c11;-Wall;-Wextra;-pedantic;-Werror>"
  "$<${_debug}:-g;-O0>"
  "$<$<AND:${_fortran},${_debug}>:-fcheck=all,no-array-temps;-finit-real=snan;-fbacktrace>")

if(AMONTONS_SANITIZE)
  target_compile_options(amontons_flags INTERFACE -fsanitize=address,undefined -fno-omit-frame-pointer)
  target_link_options(amontons_flags INTERFACE -fsanitize=address,undefined)
endif()
if(AMONTONS_COVERAGE)
  target_compile_options(amontons_flags INTERFACE --coverage)
  target_link_options(amontons_flags INTERFACE --coverage)
endif()
