# Installs the licences of what is compiled into xrds beside its own, as these ask for in binaries that are given away:
# where Debian's packages brought the sources, whose files they are. scripts/wheel_licenses.sh does it for wheels.
include(GNUInstallDirs)

function(xrds_licences component)
  foreach(package IN LISTS ARGN)
    set(file /usr/share/doc/${package}/copyright)
    if(EXISTS ${file})
      install(FILES ${file} DESTINATION ${CMAKE_INSTALL_DOCDIR}/licenses RENAME ${package}.txt COMPONENT ${component})
    endif()
  endforeach()
endfunction()

xrds_licences(library nlohmann-json3-dev libvulkan-volk-dev)
if(MINGW)
  xrds_licences(library gcc-mingw-w64-x86-64-posix-runtime)
endif()
if(XRDS_COMMAND)
  xrds_licences(command nlohmann-json3-dev libvulkan-volk-dev libcli11-dev)
  if(MINGW)  # scripts/windows.sh links them statically
    xrds_licences(command libopenexr-dev libimath-dev libpng-dev libz-mingw-w64-dev)
  endif()
  if(TARGET xrds_view)
    xrds_licences(command libimgui-dev)
  endif()
endif()
