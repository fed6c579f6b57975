# How every target of this tree is built.

add_library(scanloom_options INTERFACE)
target_include_directories(scanloom_options INTERFACE ${CMAKE_SOURCE_DIR})
target_compile_options(scanloom_options INTERFACE -Wall -Wextra -Wconversion -Wshadow -Wno-missing-field-initializers
                                                  # nothing is fused: the same bits whatever instructions the kernels
                                                  # are compiled for. The C library's sin, cos and atan2 may still differ
                                                  # in their last bits between its versions and between processors.
                                                  -ffp-contract=off)
if(DEFINED ENV{CI})
  target_compile_options(scanloom_options INTERFACE -Werror)
endif()
if(CMAKE_UNITY_BUILD AND CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  add_compile_options(-Wno-subobject-linkage) # it takes the files that are put together for headers
endif()
if(SCANLOOM_SANITIZE)
  add_compile_options(-fsanitize=${SCANLOOM_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${SCANLOOM_SANITIZE})
  if(SCANLOOM_SANITIZE MATCHES thread AND CMAKE_CXX_COMPILER_ID STREQUAL GNU)
    add_compile_options(-Wno-tsan) # it does not follow fences; Asio has some, beside its locks
  endif()
endif()

# What follows takes ALONE, too: files that are compiled by themselves also where the others are put together
# (CMAKE_UNITY_BUILD), as names of theirs that are nobody else's business are those of another file as well.
function(scanloom_alone)
  set_source_files_properties(${ARGN} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()

# scanloom_library(NAME SOURCES a.cpp ... [ALONE a.cpp ...] LINKS target ...)
# One folder, one library; LINKS are the folders and packages it may include.
function(scanloom_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;ALONE;LINKS" ${ARGN})
  scanloom_alone(${ARG_ALONE})
  if(ARG_SOURCES)
    add_library(${name} STATIC ${ARG_SOURCES})
    target_link_libraries(${name} PUBLIC scanloom_options ${ARG_LINKS})
  else()
    add_library(${name} INTERFACE)
    target_link_libraries(${name} INTERFACE scanloom_options ${ARG_LINKS})
  endif()
endfunction()

# scanloom_program(NAME SOURCES main.cpp ... [ALONE a.cpp ...] LINKS target ...)
function(scanloom_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;ALONE;LINKS" ${ARGN})
  scanloom_alone(${ARG_ALONE})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE scanloom_options ${ARG_LINKS})
endfunction()

# scanloom_test(NAME [ONE_THREAD] SOURCES x_test.cpp ... [ALONE a.cpp ...] LINKS target ...)
# One executable; each of its cases is a test of CTest's. ONE_THREAD: ThreadSanitizer has nothing to see in it.
function(scanloom_test name)
  cmake_parse_arguments(ARG "ONE_THREAD" "" "SOURCES;ALONE;LINKS;ENVIRONMENT" ${ARGN})
  scanloom_alone(${ARG_ALONE})
  add_executable(${name} ${ARG_SOURCES})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  target_link_libraries(${name} PRIVATE scanloom_options GTest::gmock GTest::gtest_main ${ARG_LINKS})
  # g++ 12 sees overlaps that are not there in "text" + std::string (GCC bug 105651).
  target_compile_options(${name} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
  set(seconds 300)
  if(SCANLOOM_SANITIZE)
    set(seconds 1800) # brute force takes twenty times as long
  endif()
  set(labels "")
  if(ARG_ONE_THREAD)
    set(labels LABELS one_thread)
  endif()
  gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST PROPERTIES ${labels} TIMEOUT ${seconds} ENVIRONMENT "${ARG_ENVIRONMENT}")
endfunction()
