#include "server/store/store_error.hpp"

#include <rocksdb/status.h>

namespace scanloom::store {

Error no_such_session(SessionId session) {
    return {Errc::kNotFound, fmt::format("the store has no session {}; it may have been removed", session)};
}

Errc code_of(const rocksdb::Status& status) {
    return status.IsCorruption() || status.IsPathNotFound() ? Errc::kDataLoss : Errc::kStoreFailed;
}

Error cannot_open(const std::filesystem::path& directory, const rocksdb::Status& status) {
    if (status.IsCorruption()) {
        return {Errc::kDataLoss, fmt::format("the store {} cannot be opened: it is damaged ({}); {}",
                                             directory.native(), status.ToString(), kRecover)};
    }
    return failure("the store {} cannot be opened: {}{}", directory.native(),
                   status.IsNoSpace() ? "the disk is full: " : "", status.ToString());
}

} // namespace scanloom::store
