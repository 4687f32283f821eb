# Installs xrds into a folder of its own, builds the project beside this file against it, and runs both:
# cmake -D BUILD=... -D SOURCE=... -D CONFIG=... -D GENERATOR=... -D WORK=... -D SANITIZE=... -P run.cmake
function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE code OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT code EQUAL 0)
    string(JOIN " " command ${ARGV})
    message(FATAL_ERROR "${command}\nended with ${code}:\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${WORK})
set(prefix ${WORK}/prefix)
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix} --config ${CONFIG})
if(SANITIZE)  # a library with sanitizers wants a program with them
  set(flags -D CMAKE_CXX_FLAGS=-fsanitize=${SANITIZE})
endif()
run(${CMAKE_COMMAND} -S ${SOURCE}/tests/consumer -B ${WORK}/build -G ${GENERATOR} -D CMAKE_BUILD_TYPE=${CONFIG} -D CMAKE_PREFIX_PATH=${prefix} ${flags})
run(${CMAKE_COMMAND} --build ${WORK}/build --config ${CONFIG})
run(${WORK}/build/consumer ${prefix}/share/xrds/models/xrds-x4-compact.safetensors)

# A name that only the installed folder has shows that the installed program looks there.
file(COPY_FILE ${SOURCE}/tests/golden/s4_guided.model.safetensors ${prefix}/share/xrds/models/only-installed.safetensors)
run(${prefix}/bin/xrds info only-installed)
run(${prefix}/bin/xrds info)
if(NOT output MATCHES "only-installed" OR NOT output MATCHES "xrds-x4-compact")
  message(FATAL_ERROR "the installed program lists\n${output}")
endif()
