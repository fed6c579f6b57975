#pragma once

#include "common/error/error.hpp"
#include "server/store/scan_log.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <string_view>
#include <utility>

namespace rocksdb {
class Status;
}

/// Errors of the store, and the advice that ends their messages.
namespace scanloom::store {

/// Advice for a damaged store; see docs/operations.md.
inline constexpr std::string_view kRecover =
    "restore it from a backup (--restore), or copy its intact entries to a new store (--repair)";

/// Advice for a store in which one session is damaged and the others are served.
inline constexpr std::string_view kRecoverOrRemove =
    "remove the session, or restore the store from a backup (--restore), or copy its intact entries to a new store "
    "(--repair)";

/// Returns a kStoreFailed error with the formatted message.
template <class... Args>
[[nodiscard]] Error failure(fmt::format_string<Args...> text, Args&&... args) {
    return {Errc::kStoreFailed, fmt::format(text, std::forward<Args>(args)...)};
}

/// Returns the error for a session that is not in the store.
[[nodiscard]] Error no_such_session(SessionId session);

/// Returns the error code of a failed read: kDataLoss if bytes are wrong or their file is missing; kStoreFailed if the
/// disk could not be read, which may be temporary.
[[nodiscard]] Errc code_of(const rocksdb::Status& status);

/// Returns the error for a store that RocksDB does not open.
[[nodiscard]] Error cannot_open(const std::filesystem::path& directory, const rocksdb::Status& status);

} // namespace scanloom::store
