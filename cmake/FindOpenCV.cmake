# Finds single OpenCV modules: targets opencv_core, opencv_imgproc, opencv_imgcodecs, ...
# Debian keeps OpenCV's own CMake files in libopencv-dev, which brings all of OpenCV and its GUI
# along; the headers and libraries of one module are packages of their own.
find_path(OpenCV_INCLUDE_DIR opencv2/core/version.hpp PATH_SUFFIXES opencv4)
mark_as_advanced(OpenCV_INCLUDE_DIR)

if(OpenCV_INCLUDE_DIR)
  file(STRINGS ${OpenCV_INCLUDE_DIR}/opencv2/core/version.hpp version_lines
       REGEX "define CV_VERSION_(MAJOR|MINOR|REVISION)")
  string(REGEX MATCHALL " [0-9]+" numbers "${version_lines}")
  string(REPLACE "; " "." numbers "${numbers}")
  string(STRIP "${numbers}" OpenCV_VERSION)
endif()

foreach(module IN LISTS OpenCV_FIND_COMPONENTS)
  find_library(OpenCV_${module}_LIBRARY opencv_${module})
  mark_as_advanced(OpenCV_${module}_LIBRARY)
  if(OpenCV_${module}_LIBRARY AND EXISTS ${OpenCV_INCLUDE_DIR}/opencv2/${module}.hpp)
    set(OpenCV_${module}_FOUND TRUE)
  endif()
endforeach()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OpenCV REQUIRED_VARS OpenCV_INCLUDE_DIR VERSION_VAR OpenCV_VERSION HANDLE_COMPONENTS)

if(OpenCV_FOUND)
  foreach(module IN LISTS OpenCV_FIND_COMPONENTS)
    if(NOT TARGET opencv_${module})
      add_library(opencv_${module} SHARED IMPORTED)
      set_target_properties(opencv_${module} PROPERTIES IMPORTED_LOCATION ${OpenCV_${module}_LIBRARY})
      target_include_directories(opencv_${module} SYSTEM INTERFACE ${OpenCV_INCLUDE_DIR})
    endif()
  endforeach()
endif()
