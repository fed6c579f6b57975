# What Scanloom is built from: Debian 12 packages, listed in packages.txt.
find_package(Threads REQUIRED)
find_package(Boost 1.81 REQUIRED COMPONENTS json)
find_package(BZip2 REQUIRED)
find_package(ZLIB REQUIRED)
find_package(Protobuf 3.21 REQUIRED)
find_package(fmt REQUIRED)
find_package(yaml-cpp 0.7 REQUIRED)
find_package(CLI11 2.1 REQUIRED)
find_package(OpenSSL 3.0 REQUIRED COMPONENTS Crypto SSL)
find_package(zstd 1.5 CONFIG REQUIRED)
if(SCANLOOM_SERVER)
  find_package(Boost 1.81 REQUIRED COMPONENTS url iostreams) # iostreams: for tests only
  find_package(Eigen3 3.4 REQUIRED)
  find_package(OpenCV 4.6 REQUIRED COMPONENTS core imgproc imgcodecs)
  find_package(spdlog 1.10 REQUIRED)
  find_package(RocksDB 7.8 REQUIRED)
  find_package(prometheus-cpp REQUIRED)
  find_package(hwy 1.0 CONFIG REQUIRED)
  find_package(nanoflann 1.4 CONFIG REQUIRED)
  # Its headers alone: one file uses them, and Debian's library would be one more to install.
  find_path(TOMLPLUSPLUS_INCLUDE_DIR toml++/toml.h REQUIRED)
  mark_as_advanced(TOMLPLUSPLUS_INCLUDE_DIR)
endif()

# Asio and Beast, compiled once instead of in every file that includes them.
add_library(scanloom_asio STATIC ${CMAKE_SOURCE_DIR}/cmake/asio.cpp)
target_compile_features(scanloom_asio PUBLIC cxx_std_20)
target_compile_definitions(scanloom_asio PUBLIC BOOST_ASIO_SEPARATE_COMPILATION BOOST_BEAST_SEPARATE_COMPILATION
                                                BOOST_ASIO_NO_DEPRECATED)
target_link_libraries(scanloom_asio PUBLIC Boost::headers OpenSSL::SSL Threads::Threads)
