#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace scanloom::fuzz {

/// Aborts if a property does not hold: libFuzzer keeps the input.
inline void check(bool holds, std::string_view claim) {
    if (holds) return;
    std::fprintf(stderr, "broken: %.*s\n", static_cast<int>(claim.size()), claim.data());
    std::abort();
}

} // namespace scanloom::fuzz

/// Begins the function of the fuzzer NAME, which takes `const std::uint8_t* data, std::size_t size` and returns 0.
///
/// With libFuzzer each fuzzer is a program. Otherwise all fuzzers are functions of `http_test`, which runs each on its
/// corpus (replay_test.cpp).
#ifdef SCANLOOM_LIBFUZZER
#define SCANLOOM_FUZZER(NAME) extern "C" int LLVMFuzzerTestOneInput
#else
#define SCANLOOM_FUZZER(NAME) int NAME##_fuzzer
#endif
