#pragma once

#include "load/core/report.hpp"

#include <cstdint>

namespace scanloom::load {

/// CPU time and memory of this process so far.
[[nodiscard]] ProcessUse own_use();

/// Lets this process have as many descriptors as it may; says how many these are.
[[nodiscard]] std::uint64_t raise_descriptor_limit();

} // namespace scanloom::load
