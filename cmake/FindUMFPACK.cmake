# Finds UMFPACK of SuiteSparse where the system brings neither a pkg-config file nor a CMake package (Debian 12).
# Defines the imported target UMFPACK::UMFPACK.
include("${CMAKE_CURRENT_LIST_DIR}/FindOneLibrary.cmake")
find_one_library(UMFPACK umfpack.h umfpack)
