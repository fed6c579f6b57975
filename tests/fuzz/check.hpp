#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace scanloom::fuzz {

/// Aborts if a property does not hold: libFuzzer keeps the input.
inline void check(bool holds, std::string_view claim) {
    if (holds) return;
    std::fprintf(stderr, "broken: %.*s\n", static_cast<int>(claim.size()), claim.data());
    std::abort();
}

/// A fuzzer as a function of a test program.
struct Fuzzer {
    std::string name; ///< also of its corpus
    int (*run)(const std::uint8_t* data, std::size_t size);
};

/// Returns the fuzzers of this program, which SCANLOOM_FUZZER adds before main().
inline std::vector<Fuzzer>& fuzzers() {
    static std::vector<Fuzzer> all;
    return all;
}

/// Adds a fuzzer to fuzzers().
/// @return true, so that the initializer of a variable can call it
inline bool add_fuzzer(Fuzzer fuzzer) {
    fuzzers().push_back(std::move(fuzzer));
    return true;
}

} // namespace scanloom::fuzz

/// Begins the function of the fuzzer NAME, which takes `const std::uint8_t* data, std::size_t size` and returns 0.
///
/// With libFuzzer each fuzzer is a program. Otherwise it is a function of a test program, which runs it on its corpus
/// (replay_test.cpp).
#ifdef SCANLOOM_LIBFUZZER
#define SCANLOOM_FUZZER(NAME) extern "C" int LLVMFuzzerTestOneInput
#else
#define SCANLOOM_FUZZER(NAME)                                                                                          \
    static int NAME##_fuzzer(const std::uint8_t* data, std::size_t size);                                              \
    [[maybe_unused]] static const bool NAME##_added = scanloom::fuzz::add_fuzzer({#NAME, NAME##_fuzzer});              \
    static int NAME##_fuzzer
#endif
