#pragma once

#include <string_view>
#include <vector>

/// Selects the processor's instruction set for the kernels. All sets give the same bits.
namespace scanloom::mapping::simd {

/// Returns the instruction sets that the program was compiled for and that this machine supports, fastest first, e.g.
/// "AVX3" (AVX-512), "AVX2", "SSE4", "SCALAR" (plain code).
[[nodiscard]] std::vector<std::string_view> instruction_sets();

/// Returns the instruction set in use: the fastest, unless use_instruction_set() selected another.
[[nodiscard]] std::string_view instruction_set();

/// Selects an instruction set, for tests and benchmarks.
/// @param name  one of instruction_sets(), or empty for the fastest
/// Threads: no other thread may be integrating scans.
void use_instruction_set(std::string_view name);

} // namespace scanloom::mapping::simd
