# Run by cpack before it makes packages: puts into each what Debian's policy wants of it and other systems do not have.
if(NOT CPACK_GENERATOR STREQUAL DEB)
  return()
endif()
find_program(GZIP gzip REQUIRED)

function(compress file)
  execute_process(COMMAND ${GZIP} --best --no-name --force ${file} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

string(TIMESTAMP year "%Y" UTC)  # of SOURCE_DATE_EPOCH, where that is set
execute_process(COMMAND date -u -R -d "@$ENV{SOURCE_DATE_EPOCH}" OUTPUT_VARIABLE date ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
if(NOT date)
  execute_process(COMMAND date -u -R OUTPUT_VARIABLE date OUTPUT_STRIP_TRAILING_WHITESPACE)
endif()
file(READ ${CPACK_XRDS_SOURCE}/LICENSE licence)
string(REGEX REPLACE "^MIT License\n+(Copyright \\(c\\) [^\n]*)\n+" "" licence "${licence}")
string(REGEX REPLACE "^Copyright \\(c\\) " "" holder "${CMAKE_MATCH_1}")
string(REGEX REPLACE "\n+$" "" licence "${licence}")
string(REGEX REPLACE "\n\n" "\n.\n" licence "${licence}")
string(REPLACE "\n" "\n " licence " ${licence}")

foreach(pair IN LISTS CPACK_XRDS_PACKAGES)
  string(REGEX MATCH "^(.*)=(.*)$" pair ${pair})
  set(root ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/${CMAKE_MATCH_1})
  set(package ${CMAKE_MATCH_2})
  set(folder ${root}/usr/share/doc/${package})
  file(MAKE_DIRECTORY ${folder})
  if(NOT package STREQUAL xrds AND IS_DIRECTORY ${root}/usr/share/doc/xrds)
    file(COPY ${root}/usr/share/doc/xrds/ DESTINATION ${folder})
    file(REMOVE_RECURSE ${root}/usr/share/doc/xrds)
  endif()
  file(REMOVE ${folder}/LICENSE)  # it is in the file of the next line
  file(WRITE ${folder}/copyright "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: xrds

Files: *
Copyright: ${holder}
License: Expat

License: Expat
${licence}
")
  file(WRITE ${folder}/changelog.Debian "xrds (${CPACK_PACKAGE_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}) unstable; urgency=medium

  * Version ${CPACK_PACKAGE_VERSION}.

 -- ${CPACK_PACKAGE_CONTACT}  ${date}
")
  compress(${folder}/changelog.Debian)
  file(GLOB pages ${root}/usr/share/man/man*/*.[1-9])
  foreach(page IN LISTS pages)
    compress(${page})
  endforeach()
  # Debian's zsh looks for what packages bring in a folder of its own.
  if(EXISTS ${root}/usr/share/zsh/site-functions)
    file(RENAME ${root}/usr/share/zsh/site-functions ${root}/usr/share/zsh/vendor-completions)
  endif()
endforeach()
