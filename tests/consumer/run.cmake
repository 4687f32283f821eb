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

# Without the models of the environment, and under the validation layer, which prints what it finds; a loader that does not
# find the layer only warns.
function(run_validated)
  run(${CMAKE_COMMAND} -E env --unset=XRDS_MODELS VK_INSTANCE_LAYERS=VK_LAYER_KHRONOS_validation
      VK_LAYER_ENABLES=VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT ${ARGV})
  if(output MATCHES "VUID|SYNC-|UNASSIGNED|Validation")
    message(FATAL_ERROR "${ARGV}\nis not valid:\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${WORK})
set(prefix ${WORK}/prefix)
if(UNIX)
  run(${SOURCE}/scripts/install.sh --prefix ${prefix} --build ${BUILD})
  if(NOT output MATCHES "Installed in ${prefix}" OR NOT output MATCHES "export PATH=\"${prefix}/bin:")
    message(FATAL_ERROR "scripts/install.sh says\n${output}")
  endif()
  foreach(file share/man/man1/xrds.1 share/bash-completion/completions/xrds share/fish/vendor_completions.d/xrds.fish
          share/zsh/site-functions/_xrds share/doc/xrds/LICENSE share/xrds/models/xrds-x4-compact.md)
    if(NOT EXISTS ${prefix}/${file})
      message(FATAL_ERROR "${file} is not installed")
    endif()
  endforeach()
  # What is installed is what scripts/build.sh builds, or the installation of a fresh build would end half-way.
  find_program(NINJA ninja)
  if(NINJA AND GENERATOR STREQUAL Ninja)
    run(${NINJA} -C ${BUILD} -t commands xrds_product)
    set(built "${output}")
    file(STRINGS ${BUILD}/install_manifest.txt installed REGEX "/bin/|/xrds[.]1$|/fish/|/zsh/|/lib[^/]*[.]so[.0-9]*$")
    foreach(file IN LISTS installed)
      get_filename_component(name ${file} NAME)
      string(FIND "${built}" "/${name}" at)
      if(at LESS 0)
        message(FATAL_ERROR "The target xrds_product does not build ${name}, which is installed")
      endif()
    endforeach()
  endif()
  # Every option that the help of a command has stands in the manual page.
  file(READ ${prefix}/share/man/man1/xrds.1 page)
  set(verbs "" upscale compare info devices doctor bench "bench quality" "bench network" "bench skip" "bench stress"
      "bench tiles")
  if(EXISTS ${prefix}/bin/xrds-view)
    list(APPEND verbs view)
  endif()
  foreach(verb IN LISTS verbs)
    separate_arguments(words UNIX_COMMAND "${verb}")
    run(${prefix}/bin/xrds ${words} --help)
    string(REGEX MATCHALL "\n  (-[a-z],)?--[a-z-]+" options "${output}")
    foreach(option ${options})
      string(REGEX REPLACE "^.*--" "--" option ${option})
      string(REPLACE "-" "\\-" option ${option})
      string(FIND "${page}" "${option}" at)
      if(at LESS 0)
        message(FATAL_ERROR "The manual page has no ${option} of xrds ${verb}")
      endif()
    endforeach()
  endforeach()
else()
  run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix} --config ${CONFIG})
endif()
if(SANITIZE)  # a library with sanitizers wants a program with them
  set(flags -D CMAKE_CXX_FLAGS=-fsanitize=${SANITIZE})
endif()
run(${CMAKE_COMMAND} -S ${SOURCE}/tests/consumer -B ${WORK}/build -G ${GENERATOR} -D CMAKE_BUILD_TYPE=${CONFIG} -D CMAKE_PREFIX_PATH=${prefix} ${flags})
run(${CMAKE_COMMAND} --build ${WORK}/build --config ${CONFIG})
run(${WORK}/build/consumer ${prefix}/share/xrds/models/xrds-x4-compact.safetensors)

# The example in C, from where it is installed, as its head says it is built. The library finds its models.
find_program(PKG_CONFIG pkg-config)
if(PKG_CONFIG AND UNIX AND NOT SANITIZE)
  file(GLOB_RECURSE pc ${prefix}/*/xrds.pc)
  cmake_path(GET pc PARENT_PATH folder)
  run(${CMAKE_COMMAND} -E env PKG_CONFIG_PATH=${folder} ${PKG_CONFIG} --cflags --libs xrds)
  separate_arguments(flags UNIX_COMMAND "${output}")
  cmake_path(GET folder PARENT_PATH libraries)
  run(cc -std=c11 -Wall -Wextra -Werror ${prefix}/share/doc/xrds/examples/upscale.c ${flags} -Wl,-rpath,${libraries} -o ${WORK}/upscale)
  run(${WORK}/build/frames write ${WORK})
  run_validated(${WORK}/upscale xrds-x4-nano ${WORK}/colour.pfm ${WORK}/albedo.pfm ${WORK}/normal.pfm ${WORK}/result.pfm)
  run(${WORK}/build/frames check ${WORK})

  # The renderer with a device of its own, as its CMakeLists.txt says; of 16 x 16 pixels, for which kernels are quick to
  # compile. The picture is 64 x 64 pixels of three floats behind a head of 12 characters, lit and finite.
  run(${CMAKE_COMMAND} -S ${prefix}/share/doc/xrds/examples/embed_vulkan -B ${WORK}/embed -G ${GENERATOR}
      -D CMAKE_BUILD_TYPE=${CONFIG} -D CMAKE_PREFIX_PATH=${prefix} -D CMAKE_C_FLAGS=-Wall\ -Wextra\ -Werror)
  run(${CMAKE_COMMAND} --build ${WORK}/embed --config ${CONFIG})
  run_validated(${WORK}/embed/embed_vulkan ${WORK}/traced.pfm xrds-x4-nano 16 16)
  if(NOT output MATCHES "frame 2: xrdsRecord took")
    message(FATAL_ERROR "embed_vulkan says\n${output}")
  endif()
  run(${WORK}/build/frames lit ${WORK}/traced.pfm 64 64)
endif()

run(${CMAKE_COMMAND} -E env --unset=XRDS_MODELS ${prefix}/bin/xrds upscale ${SOURCE}/samples/outdoor_lr64.exr
    ${SOURCE}/samples/outdoor_aux16.exr -o ${WORK}/out.exr --model xrds-x4-nano)

# A name that only the installed folder has shows that the installed program looks there.
file(COPY_FILE ${SOURCE}/tests/golden/s4_guided.model.safetensors ${prefix}/share/xrds/models/only-installed.safetensors)
run(${prefix}/bin/xrds info only-installed)
run(${prefix}/bin/xrds info)
if(NOT output MATCHES "only-installed" OR NOT output MATCHES "xrds-x4-compact")
  message(FATAL_ERROR "the installed program lists\n${output}")
endif()
