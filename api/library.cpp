// The shared library is the static one, whole: CMake wants a source of its own.
