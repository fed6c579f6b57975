#pragma once

#include <optional>

namespace scanloom::testing_support {

/// How many allocations of this thread succeed before one throws std::bad_alloc, which resets it; nullopt: all succeed.
/// A program that uses it gets another operator new.
extern constinit thread_local std::optional<int> allocations_left;

} // namespace scanloom::testing_support
