#include "common/app/machine.hpp"

#include <fmt/format.h>

#include <fstream>
#include <thread>

namespace scanloom {
namespace {

std::string processor() {
    std::ifstream info("/proc/cpuinfo");
    for (std::string line; std::getline(info, line);) {
        const auto value = line.find(": ");
        const bool names_it = line.starts_with("model name") || line.starts_with("Model"); // x86, Arm boards
        if (names_it && value != std::string::npos) return line.substr(value + 2) + ", ";
    }
    return "";
}

} // namespace

std::string machine_description() {
#ifdef __OPTIMIZE__
    constexpr const char* kOptimisation = "with optimisation";
#else
    constexpr const char* kOptimisation = "without optimisation";
#endif
#ifdef __clang__
    constexpr const char* kCompiler = "clang";
#else
    constexpr const char* kCompiler = "g++";
#endif
    return fmt::format("{}{} cores, {} {} {}", processor(), std::thread::hardware_concurrency(), kCompiler, __VERSION__,
                       kOptimisation);
}

} // namespace scanloom
