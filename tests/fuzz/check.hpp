#pragma once

#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace scanloom::fuzz {

/// A claim that must hold for every input: libFuzzer keeps the input that breaks it.
inline void check(bool holds, std::string_view claim) {
    if (holds) return;
    std::fprintf(stderr, "broken: %.*s\n", static_cast<int>(claim.size()), claim.data());
    std::abort();
}

} // namespace scanloom::fuzz
