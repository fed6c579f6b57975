#pragma once

#include <string_view>

namespace scanloom::store {

/// What to do about a damaged store: the end of a sentence that says what is damaged. docs/operations.md says how.
inline constexpr std::string_view kBringBack =
    "restore it from a backup (--restore), or save what is intact of it into a new store (--repair)";

/// The same where one session is damaged and the others are served.
inline constexpr std::string_view kBringBackOrRemove =
    "remove the session, or restore the store from a backup (--restore), or save what is intact of it into a new store "
    "(--repair)";

} // namespace scanloom::store
