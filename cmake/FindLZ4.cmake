# Finds LZ4 with its frame format: target LZ4::lz4. Debian's package has no CMake files.
find_path(LZ4_INCLUDE_DIR lz4frame.h)
find_library(LZ4_LIBRARY lz4)
mark_as_advanced(LZ4_INCLUDE_DIR LZ4_LIBRARY)

if(LZ4_INCLUDE_DIR)
  file(STRINGS ${LZ4_INCLUDE_DIR}/lz4.h version_lines REGEX "define LZ4_VERSION_(MAJOR|MINOR|RELEASE) ")
  string(REGEX MATCHALL " [0-9]+" numbers "${version_lines}")
  string(REPLACE "; " "." numbers "${numbers}")
  string(STRIP "${numbers}" LZ4_VERSION)
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(LZ4 REQUIRED_VARS LZ4_LIBRARY LZ4_INCLUDE_DIR VERSION_VAR LZ4_VERSION)

if(LZ4_FOUND AND NOT TARGET LZ4::lz4)
  add_library(LZ4::lz4 SHARED IMPORTED)
  set_target_properties(LZ4::lz4 PROPERTIES IMPORTED_LOCATION ${LZ4_LIBRARY})
  target_include_directories(LZ4::lz4 SYSTEM INTERFACE ${LZ4_INCLUDE_DIR})
endif()
