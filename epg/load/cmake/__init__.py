"""CMake's files read without running CMake: as far as that can be known."""
