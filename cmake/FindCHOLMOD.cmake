# Finds CHOLMOD and CAMD of SuiteSparse where the system brings neither a pkg-config file nor a CMake package
# (Debian 12). Defines the imported target CHOLMOD::CHOLMOD.
include("${CMAKE_CURRENT_LIST_DIR}/FindOneLibrary.cmake")
find_one_library(CHOLMOD cholmod.h cholmod camd suitesparseconfig)
