# What a Python wheel holds besides the Python package: the program and the library that the package loads, both in its
# folder.
install(TARGETS amontons_app RUNTIME DESTINATION amontons/bin)
install(TARGETS amontons_c LIBRARY DESTINATION amontons)
