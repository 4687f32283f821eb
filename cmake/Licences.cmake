# Installs the licences of what is compiled into xrds beside its own, as these ask for in binaries that are given away:
# where Debian's packages brought the sources, whose files they are.
include(GNUInstallDirs)
set(licences ${CMAKE_INSTALL_DOCDIR}/licenses)
set(of_library nlohmann-json3-dev libvulkan-volk-dev)
set(of_command ${of_library} libcli11-dev libopenexr-dev libimath-dev)  # of the last two what their headers define

function(xrds_licences component)
  foreach(package IN LISTS ARGN)
    set(file /usr/share/doc/${package}/copyright)
    if(EXISTS ${file})
      install(FILES ${file} DESTINATION ${licences} RENAME ${package}.txt COMPONENT ${component})
    endif()
  endforeach()
endfunction()

if(SKBUILD)  # scripts/wheel_licenses.sh adds those of the libraries that go beside it
  set(licences ${SKBUILD_METADATA_DIR}/licenses)
  xrds_licences(python ${of_command})
  execute_process(
    COMMAND ${Python_EXECUTABLE} -c "import importlib.metadata as m; print(next(f.locate() for f in m.files('nanobind') if f.name == 'LICENSE'))"
    OUTPUT_VARIABLE nanobind_licence OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(nanobind_licence)
    install(FILES ${nanobind_licence} DESTINATION ${licences} RENAME nanobind.txt COMPONENT python)
  else()  # of a distribution, whose packages keep no list of their files
    message(WARNING "The wheel does not have the licence of nanobind, which does not say where that is.")
  endif()
  set(robin_map ${NB_DIR}/ext/robin_map/include/tsl/robin_map.h)  # nanobind is made with it; the licence is its first comment
  if(EXISTS ${robin_map})
    file(READ ${robin_map} licence)
    string(REGEX REPLACE "\\*/.*" "" licence "${licence}")
    string(REGEX REPLACE "(^|\n)[ /*]+" "\\1" licence "${licence}")
    file(WRITE ${PROJECT_BINARY_DIR}/robin_map.txt "${licence}")
    install(FILES ${PROJECT_BINARY_DIR}/robin_map.txt DESTINATION ${licences} COMPONENT python)
  else()
    message(WARNING "The wheel does not have the licence of robin_map, which is not beside nanobind.")
  endif()
  return()
endif()

xrds_licences(library ${of_library})
if(MINGW)
  xrds_licences(library gcc-mingw-w64-x86-64-posix-runtime mingw-w64-x86-64-dev)  # the latter's is libwinpthread-1.dll
endif()
if(XRDS_COMMAND)
  xrds_licences(command ${of_command})
  if(MINGW)  # scripts/windows.sh links them statically
    xrds_licences(command libpng-dev libz-mingw-w64-dev)
  endif()
  if(TARGET xrds_view)
    xrds_licences(command libimgui-dev libassimp-dev libstb-dev)
  endif()
endif()
