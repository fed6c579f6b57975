# How the targets of this tree are built. docs/internals/build.md says what each measure saves.

add_library(scanloom_options INTERFACE)
target_include_directories(scanloom_options INTERFACE ${CMAKE_SOURCE_DIR})
# -ffp-contract=off: no fused multiply-add, so that results have the same bits whatever instructions the kernels are
# compiled for. The C library's sin, cos and atan2 may still differ in their last bits between versions and processors.
target_compile_options(scanloom_options INTERFACE -Wall -Wextra -Wconversion -Wshadow -Wno-missing-field-initializers
                                                  -ffp-contract=off)
# Other compilers may have new warnings, which must not stop a build.
if(SCANLOOM_WERROR AND CMAKE_SYSTEM_PROCESSOR STREQUAL x86_64
   AND "${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION}" MATCHES "^GNU 12[.]")
  target_compile_options(scanloom_options INTERFACE -Werror)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  if(CMAKE_UNITY_BUILD)
    add_compile_options(-Wno-subobject-linkage) # g++ takes the sources of a unity file for headers
  endif()
  if(NOT CMAKE_DISABLE_PRECOMPILE_HEADERS)
    # For ccache; and a precompiled header that does not fit its target is an error, not only a slow build.
    add_compile_options(-fpch-preprocess -Werror=invalid-pch)
  endif()
  add_compile_options(--param=ggc-min-heapsize=1048576) # collect garbage only beyond 1 GiB: saves an eighth of the time
  # False alarms of g++ 12: it takes the operators new and delete of Asio's coroutine frames for a mismatched pair, sees
  # std::string_view::find() read beyond the end, and the other alternative of a moved variant used without a value.
  add_compile_options(-Wno-mismatched-new-delete -Wno-stringop-overread -Wno-maybe-uninitialized)
  # The client library is linked into plugins and hides what it was built with (robot_client/package). All targets are
  # built the same way, because a precompiled header serves only targets with equal -f options.
  add_compile_options(-fno-semantic-interposition -fno-gnu-unique)
endif()
# For programs too, where CMAKE_POSITION_INDEPENDENT_CODE means -fPIE: they share precompiled headers.
add_compile_options(-fPIC)
if(SCANLOOM_SANITIZE)
  add_compile_options(-fsanitize=${SCANLOOM_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${SCANLOOM_SANITIZE})
  if(SCANLOOM_SANITIZE MATCHES thread AND CMAKE_CXX_COMPILER_ID STREQUAL GNU)
    add_compile_options(-Wno-tsan) # it does not follow fences; Asio has some, next to its locks
  endif()
endif()

# Optimization by kind of code, in release builds: compute -O3; io, code whose speed is limited by sockets, devices or
# files, -O1; tests -Og.
# Each kind has one precompiled header, which all targets of the kind share.
# scanloom_kind(TARGET KIND), KIND one of compute, io, test
function(scanloom_kind target kind)
  set(levels_compute -O3)
  set(levels_io -O1)
  set(levels_test -Og)
  set(packages_compute fmt::fmt)
  set(packages_io fmt::fmt Boost::json scanloom_asio)
  set(packages_test ${packages_io} GTest::gmock GTest::gtest)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:${levels_${kind}}>)
  target_link_libraries(${target} PRIVATE ${packages_${kind}})
  if(NOT target STREQUAL scanloom_${kind}_headers)
    target_precompile_headers(${target} REUSE_FROM scanloom_${kind}_headers)
  endif()
endfunction()

# scanloom_headers(KIND): the precompiled header cmake/headers/KIND.hpp.
function(scanloom_headers kind)
  set(name scanloom_${kind}_headers)
  add_library(${name} OBJECT ${CMAKE_SOURCE_DIR}/cmake/headers/empty.cpp)
  target_link_libraries(${name} PRIVATE scanloom_options)
  scanloom_kind(${name} ${kind})
  # In angle brackets, so that no path of this checkout gets into it, and ccache shares it among checkouts.
  target_precompile_headers(${name} PRIVATE <cmake/headers/${kind}.hpp>)
endfunction()

# scanloom_library(NAME [IO] SOURCES a.cpp ... LINKS target ...)
# One folder, one library; LINKS are the folders and packages it may include. IO: of the kind io.
function(scanloom_library name)
  cmake_parse_arguments(ARG "IO" "" "SOURCES;LINKS" ${ARGN})
  if(NOT ARG_SOURCES)
    add_library(${name} INTERFACE)
    target_link_libraries(${name} INTERFACE scanloom_options ${ARG_LINKS})
    return()
  endif()
  add_library(${name} STATIC ${ARG_SOURCES})
  target_link_libraries(${name} PUBLIC scanloom_options ${ARG_LINKS})
  if(ARG_IO)
    scanloom_kind(${name} io)
  else()
    scanloom_kind(${name} compute)
  endif()
endfunction()

# scanloom_equal_bits(NAME): a library whose floating-point results have the same bits for every instruction set. g++ 12
# fuses multiplications with alternating additions and subtractions in vectors although -ffp-contract=off forbids it.
# PUBLIC, because inline functions of its headers are compiled in the targets that use it.
function(scanloom_equal_bits name)
  target_compile_options(${name} PUBLIC $<$<CXX_COMPILER_ID:GNU>:-fno-tree-vectorize;-fno-tree-slp-vectorize>)
endfunction()

# scanloom_program(NAME SOURCES main.cpp ... LINKS target ...)
function(scanloom_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINKS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE scanloom_options ${ARG_LINKS})
  scanloom_kind(${name} io)
endfunction()

# scanloom_test_program(NAME [ONE_THREAD] [LABELS label ...] [TIMEOUT seconds] [TOGETHER count] [COST cost])
# An executable of GoogleTest suites. TOGETHER: suites in one CTest test, otherwise 1. COST: tests of higher cost start
# first. ONE_THREAD: a test that starts a thread ends the program; its suites have the label one_thread.
function(scanloom_test_program name)
  cmake_parse_arguments(ARG "ONE_THREAD" "COST;TIMEOUT;TOGETHER" "LABELS" ${ARGN})
  add_executable(${name})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  target_link_libraries(${name} PRIVATE scanloom_options GTest::gtest_main)
  scanloom_kind(${name} test)
  target_compile_definitions(${name} PRIVATE SCANLOOM_SOURCE_DIR="${CMAKE_SOURCE_DIR}"
                                             SCANLOOM_BUILD_DIR="${CMAKE_BINARY_DIR}")
  # g++ 12 sees overlaps that are not there in "text" + std::string (GCC bug 105651).
  target_compile_options(${name} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
  if(ARG_ONE_THREAD)
    list(APPEND ARG_LABELS one_thread)
    target_sources(${name} PRIVATE ${CMAKE_SOURCE_DIR}/tests/support/no_threads.cpp)
  endif()
  if(NOT ARG_COST)
    set(ARG_COST 0)
  endif()
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  if(NOT ARG_TOGETHER)
    set(ARG_TOGETHER 1)
  endif()
  if(SCANLOOM_SANITIZE)
    set(ARG_TIMEOUT 1800) # brute force takes twenty times as long
  endif()
  set(PROGRAM ${CMAKE_BINARY_DIR}/tests/${name})
  configure_file(${CMAKE_SOURCE_DIR}/cmake/suites.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/${name}_suites.cmake @ONLY)
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${CMAKE_CURRENT_BINARY_DIR}/${name}_suites.cmake)
endfunction()

# scanloom_test(PROGRAM SOURCES x_test.cpp ... LINKS target ...)
# Adds the tests of a folder to a test program. Units are filled in the order of these calls, across folders.
function(scanloom_test program)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINKS" ${ARGN})
  target_sources(${program} PRIVATE ${ARG_SOURCES})
  target_link_libraries(${program} PRIVATE ${ARG_LINKS})
endfunction()
