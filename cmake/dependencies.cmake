# Debian 12's packages. The CMake package files of OpenSubdiv, OpenColorIO and OpenImageIO name files that other
# packages hold, so these come through pkg-config and find_library.
find_package(PkgConfig REQUIRED)
find_package(Threads REQUIRED)
find_package(TBB REQUIRED)
find_package(PNG REQUIRED)
find_package(OpenEXR REQUIRED)
find_package(fmt REQUIRED)
find_package(spdlog REQUIRED)
find_package(CLI11 REQUIRED)
find_package(GTest REQUIRED)

pkg_check_modules(OIIO REQUIRED IMPORTED_TARGET OpenImageIO)
add_library(OpenImageIO::OpenImageIO ALIAS PkgConfig::OIIO)
pkg_check_modules(OCIO REQUIRED IMPORTED_TARGET OpenColorIO)
add_library(OpenColorIO::OpenColorIO ALIAS PkgConfig::OCIO)

# meristem_find_library(TARGET LIBRARY HEADER): the imported target of a library without usable package files.
function(meristem_find_library target library header)
  find_library(${library}_LIBRARY ${library} REQUIRED)
  find_path(${library}_INCLUDE_DIR ${header} REQUIRED)
  add_library(${target} UNKNOWN IMPORTED GLOBAL)
  set_target_properties(${target} PROPERTIES
    IMPORTED_LOCATION ${${library}_LIBRARY} INTERFACE_INCLUDE_DIRECTORIES ${${library}_INCLUDE_DIR})
endfunction()
meristem_find_library(OpenSubdiv::osdCPU osdCPU opensubdiv/version.h)
meristem_find_library(embree embree3 embree3/rtcore.h)
meristem_find_library(openvdb openvdb openvdb/version.h)

# The checks' interpreter: the system's, which has Debian's python3-jsonschema, before any other in the PATH.
find_program(MERISTEM_PYTHON python3 HINTS /usr/bin REQUIRED)

find_program(CCACHE ccache)
if(CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE})
endif()
