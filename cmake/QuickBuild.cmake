# What makes a build of everything shorter. Half of a file's compile time is headers of the standard library, which are compiled once for each
# target. Tests, and programs that read options and call the libraries, run for less time than they are compiled: they are optimized little.
set(common_headers algorithm array cmath cstdint cstring filesystem fstream functional map memory optional random set span string variant vector)

# For C++ alone: a target may have C files, too.
function(xrds_precompile target scope)
  foreach(name ${ARGN})
    target_precompile_headers(${target} ${scope} "$<$<COMPILE_LANGUAGE:CXX>:<${name}$<ANGLE-R>>")
  endforeach()
endfunction()

xrds_precompile(xrds_options INTERFACE ${common_headers})

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
  target_precompile_headers(${target} PRIVATE <gtest/gtest.h> ${ARGN})
endfunction()
