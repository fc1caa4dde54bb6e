# Finds MUMPS in double precision over MPI, which brings neither a pkg-config file nor a CMake package. Defines the
# imported target MUMPS::MUMPS.
include("${CMAKE_CURRENT_LIST_DIR}/FindOneLibrary.cmake")
find_one_library(MUMPS dmumps_c.h dmumps)
