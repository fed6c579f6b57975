#pragma once

#include "common/error/error.hpp"

#include <rocksdb/status.h>

namespace scanloom::store {

/// What a failure to read means: kDataLoss: bytes are wrong, or their file is gone; kStoreFailed: the disk could not be
/// read, and later it may.
[[nodiscard]] inline Errc code_of(const rocksdb::Status& status) {
    return status.IsCorruption() || status.IsPathNotFound() ? Errc::kDataLoss : Errc::kStoreFailed;
}

} // namespace scanloom::store
