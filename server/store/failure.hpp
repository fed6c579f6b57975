#pragma once

#include "common/error/error.hpp"

#include <fmt/format.h>

#include <utility>

namespace scanloom::store {

/// Returns a kStoreFailed error with the formatted message.
template <class... Args>
[[nodiscard]] Error failure(fmt::format_string<Args...> text, Args&&... args) {
    return {Errc::kStoreFailed, fmt::format(text, std::forward<Args>(args)...)};
}

} // namespace scanloom::store
