# What `cpack` makes of an installation: -G DEB four packages, -G TXZ and -G ZIP one archive. scripts/package.sh runs it.
set(XRDS_MAINTAINER "The xrds authors <maintainers@xrds.example>" CACHE STRING "Who answers for packages: NAME <ADDRESS>")

set(CPACK_PACKAGE_NAME xrds)
set(CPACK_PACKAGE_VENDOR "The xrds authors")
set(CPACK_PACKAGE_CONTACT "${XRDS_MAINTAINER}")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_PACKAGE_CHECKSUM SHA256)
set(CPACK_STRIP_FILES ON)
set(CPACK_VERBATIM_VARIABLES ON)
string(TOLOWER ${CMAKE_SYSTEM_NAME} system)
set(CPACK_PACKAGE_FILE_NAME xrds-${PROJECT_VERSION}-${system}-${CMAKE_SYSTEM_PROCESSOR})
set(CPACK_ARCHIVE_COMPONENT_INSTALL OFF)
set(CPACK_COMPONENTS_ALL library development models)
if(XRDS_COMMAND)
  list(APPEND CPACK_COMPONENTS_ALL command)
endif()

# A package of Debian for each component, as its policy names them.
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY ">=")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_LIST_DIR}/DebianFiles.cmake)
set(CPACK_XRDS_SOURCE ${PROJECT_SOURCE_DIR})

get_target_property(soversion xrds SOVERSION)
set(package_library libxrds${soversion})
set(package_development libxrds-dev)
set(package_models xrds-models)
set(package_command xrds)
set(exactly "(= ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE})")
set(vulkan_drivers "mesa-vulkan-drivers | vulkan-icd")

# A package's description: SUMMARY, what xrds is, "This package has CONTENT".
function(xrds_package component section summary content)
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${package_${component}} PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${section} PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_DESCRIPTION "${summary}
Makes the full-resolution picture of a low-resolution render and of
full-resolution albedo and normals, on any Vulkan 1.2 device.
This package has ${content}" PARENT_SCOPE)
endfunction()

xrds_package(library libs "upscaler of Monte Carlo renders on Vulkan - library"
  "the library, for C and C++.")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS "libvulkan1 (>= 1.2)")  # opened at run time
set(CPACK_DEBIAN_LIBRARY_PACKAGE_RECOMMENDS "xrds-models, ${vulkan_drivers}")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_LIST_DIR}/debian/triggers)

xrds_package(development libdevel "upscaler of Monte Carlo renders on Vulkan - development files"
  "the headers, and files for CMake and pkg-config.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "${package_library} ${exactly}, libvulkan-dev")  # xrds_vulkan.h has its types

xrds_package(models graphics "upscaler of Monte Carlo renders on Vulkan - models"
  "the weights of its networks, each with a card.")
set(CPACK_DEBIAN_MODELS_PACKAGE_ARCHITECTURE all)

xrds_package(command graphics "upscaler of Monte Carlo renders on Vulkan - command and viewer"
  "the command xrds and its viewer.")
set(CPACK_DEBIAN_COMMAND_PACKAGE_DEPENDS "xrds-models ${exactly}, libvulkan1 (>= 1.2)")
set(CPACK_DEBIAN_COMMAND_PACKAGE_RECOMMENDS "${vulkan_drivers}")
set(CPACK_DEBIAN_COMMAND_PACKAGE_SUGGESTS "libopenimagedenoise2")

foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  list(APPEND CPACK_XRDS_PACKAGES ${component}=${package_${component}})
endforeach()
include(CPack)
