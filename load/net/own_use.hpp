#pragma once

#include "load/core/report.hpp"

#include <cstdint>

namespace scanloom::load {

/// Returns CPU time and memory used by this process so far.
[[nodiscard]] ProcessUse own_use();

/// Raises this process's limit of file descriptors to the allowed maximum and returns it.
[[nodiscard]] std::uint64_t raise_descriptor_limit();

} // namespace scanloom::load
