#pragma once

#include <string_view>
#include <vector>

/// Which instructions of the processor the kernels use. All sets give the same bits.
namespace scanloom::mapping::simd {

/// Those that this program was built for and this machine has, the fastest first, e.g. "AVX3" (AVX-512), "AVX2",
/// "SSE4", "SCALAR" (plain code).
[[nodiscard]] std::vector<std::string_view> instruction_sets();

/// The one that is used: the first, unless use_instruction_set() chose another.
[[nodiscard]] std::string_view instruction_set();

/// For tests and benchmarks. Pre: one of instruction_sets(), or empty for the first.
/// Thread  none may be weaving.
void use_instruction_set(std::string_view name);

} // namespace scanloom::mapping::simd
