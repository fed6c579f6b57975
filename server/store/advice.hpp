#pragma once

#include <string_view>

namespace scanloom::store {

/// Tells the operator what to do about a damaged store. It ends a sentence that says what is damaged; see
/// docs/operations.md.
inline constexpr std::string_view kBringBack =
    "restore it from a backup (--restore), or save what is intact of it into a new store (--repair)";

/// Advice for a store in which one session is damaged and the others are served.
inline constexpr std::string_view kBringBackOrRemove =
    "remove the session, or restore the store from a backup (--restore), or save what is intact of it into a new store "
    "(--repair)";

} // namespace scanloom::store
