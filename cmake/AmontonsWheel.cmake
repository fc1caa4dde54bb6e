# What a Python wheel holds besides the Python package: the program and the library that the package loads, both in its
# folder; the man page and the completion of command lines, which go below the prefix of the environment.
install(TARGETS amontons_app RUNTIME DESTINATION amontons/bin)
install(TARGETS amontons_c LIBRARY DESTINATION amontons)
install(FILES "${PROJECT_SOURCE_DIR}/doc/amontons.1" DESTINATION "${SKBUILD_DATA_DIR}/share/man/man1")
install(FILES "${PROJECT_SOURCE_DIR}/doc/amontons.bash" RENAME amontons
  DESTINATION "${SKBUILD_DATA_DIR}/share/bash-completion/completions")
