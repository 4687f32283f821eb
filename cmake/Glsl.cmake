find_program(GLSLANG NAMES glslangValidator glslang REQUIRED)

# Compiles a GLSL file to SPIR-V in the header NAME.h, as the array NAME, and adds it to the target:
# xrds_glsl(TARGET NAME SOURCE [-DMACRO ...]). Programs of the same folder get headers beside each other.
function(xrds_glsl target name source)
  cmake_path(ABSOLUTE_PATH source)
  set(header ${CMAKE_CURRENT_BINARY_DIR}/${name}.h)
  add_custom_command(
    OUTPUT ${header}
    COMMAND ${GLSLANG} -V --quiet --target-env vulkan1.2 -I${PROJECT_SOURCE_DIR} ${ARGN} --depfile ${header}.d
            --vn ${name} -o ${header} ${source}
    DEPENDS ${source}
    DEPFILE ${header}.d
    VERBATIM)
  target_sources(${target} PRIVATE ${header})
  target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_BINARY_DIR})
endfunction()
