# Registers the tests of a GoogleTest program suite by suite, each suite as one test of CTest in one process: what its
# tests compile on a device they share. suite_tests(TARGET [ALONE TEST ...] [FIRST SUITE ...] [TIMEOUT SECONDS]).
# ALONE: tests that nothing else may run beside. FIRST: suites that take longest.
function(suite_tests target)
  cmake_parse_arguments(asked "" "TIMEOUT" "ALONE;FIRST" ${ARGN})
  set(list ${CMAKE_CURRENT_BINARY_DIR}/${target}_suites.cmake)
  file(GENERATE OUTPUT ${list} CONTENT "set(program \"$<TARGET_FILE:${target}>\")
set(folder \"${CMAKE_CURRENT_BINARY_DIR}\")
set(alone \"${asked_ALONE}\")
set(first \"${asked_FIRST}\")
set(timeout ${asked_TIMEOUT})
include(\"${PROJECT_SOURCE_DIR}/cmake/SuiteTestsOfProgram.cmake\")
")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${list})
endfunction()
