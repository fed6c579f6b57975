#pragma once

#include "common/error/error.hpp"

namespace scanloom::session {

/// Whether what kept a session from being read is damage of what is stored. Where memory ran out or the disk could not
/// be read, it may be whole.
[[nodiscard]] inline bool is_damage(const Error& why) noexcept {
    return why.code != Errc::kOverloaded && why.code != Errc::kStoreFailed;
}

} // namespace scanloom::session
