# What makes a build of everything shorter. Half of a file's compile time is headers of the standard library, which are compiled once: for all
# libraries, and for all programs of tests. Tests, and programs that read options and call the libraries, run for less time than they are compiled:
# they are optimized little.
set(common_headers algorithm array cmath cstdint cstring filesystem fstream functional map memory optional random set span string variant vector)

# For C++ alone: a target may have C files, too.
function(xrds_precompile target scope)
  foreach(name ${ARGN})
    target_precompile_headers(${target} ${scope} "$<$<COMPILE_LANGUAGE:CXX>:<${name}$<ANGLE-R>>")
  endforeach()
endfunction()

xrds_precompile(xrds_options INTERFACE ${common_headers})

# GCC alone: other compilers want the same definitions in every target that takes a precompiled header.
set(shared_headers OFF)
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND UNIX)
  set(shared_headers ON)
  # Without collecting garbage below half a gigabyte GCC takes a tenth less time for the largest files.
  target_compile_options(xrds_options INTERFACE $<$<COMPILE_LANGUAGE:CXX>:--param=ggc-min-heapsize=500000>)
endif()

# NAME has the precompiled header that others take.
function(xrds_shared_headers name)
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/headers/${name}.cpp CONTENT "")
  add_library(${name} OBJECT ${PROJECT_BINARY_DIR}/headers/${name}.cpp)
  target_link_libraries(${name} PUBLIC xrds_options)
endfunction()

function(take_headers_of name)
  set_target_properties(${ARGN} PROPERTIES PRECOMPILE_HEADERS_REUSE_FROM ${name})
  foreach(target ${ARGN})
    add_dependencies(${target} ${name})
  endforeach()
endfunction()

# In targets that are told by text where files are: paths of text are made by pathOf() alone.
function(explicit_paths target)
  target_precompile_headers(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:${PROJECT_SOURCE_DIR}/cmake/explicit_paths.h>)
endfunction()

# Targets of a file or two gain nothing from it.
function(no_precompiled_headers)
  set_target_properties(${ARGN} PROPERTIES DISABLE_PRECOMPILE_HEADERS ON)
endfunction()

function(optimize_little target)
  target_compile_options(${target} PRIVATE $<$<AND:$<CONFIG:Release>,$<CXX_COMPILER_ID:GNU,Clang>>:-O1>)
endfunction()

# A program of tests; names of more headers that most of its files include may follow.
function(quick_to_compile target)
  optimize_little(${target})
  if(ARGN OR NOT shared_headers)
    target_precompile_headers(${target} PRIVATE <gtest/gtest.h> ${ARGN})
    return()
  endif()
  if(NOT TARGET xrds_test_headers)
    xrds_shared_headers(xrds_test_headers)
    quick_to_compile(xrds_test_headers <gtest/gtest.h>)
    target_link_libraries(xrds_test_headers PUBLIC GTest::gtest)
    # As a program, of which a precompiled header must be one, too.
    set_target_properties(xrds_test_headers PROPERTIES POSITION_INDEPENDENT_CODE OFF)
    target_compile_options(xrds_test_headers PRIVATE -fPIE)
  endif()
  take_headers_of(xrds_test_headers ${target})
endfunction()

# At the end, of libraries that there are, and that are C++ alone.
function(share_headers)
  if(NOT shared_headers)
    return()
  endif()
  xrds_shared_headers(xrds_headers)
  foreach(target ${ARGN})
    if(TARGET ${target})
      take_headers_of(xrds_headers ${target})
    endif()
  endforeach()
endfunction()

# Files of a target compiled together, SIZE at a time, by which what they instantiate is compiled once: half the time for a build of everything,
# twice that for a change of one file. Files of which two define the same name are left apart, by apart() where the target is made.
option(XRDS_UNITY_BUILD "Compile several files at once: for a build of everything, not for work at the source" OFF)
function(compile_together size)
  if(NOT XRDS_UNITY_BUILD)
    return()
  endif()
  foreach(target ${ARGN})
    if(TARGET ${target})
      set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${size})
    endif()
  endforeach()
endfunction()

function(apart)
  set_source_files_properties(${ARGN} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()
