#pragma once

#include "common/error/error.hpp"

#include <rocksdb/status.h>

namespace scanloom::store {

/// Returns the error code of a failed read: kDataLoss if bytes are wrong or their file is missing; kStoreFailed if the
/// disk could not be read, which may be temporary.
[[nodiscard]] inline Errc code_of(const rocksdb::Status& status) {
    return status.IsCorruption() || status.IsPathNotFound() ? Errc::kDataLoss : Errc::kStoreFailed;
}

} // namespace scanloom::store
