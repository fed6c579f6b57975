#pragma once

#include "common/error/error.hpp"

#include <string>

namespace scanloom::http {

/// A body that is made while it is sent, piece by piece: what may be larger than memory.
/// Thread  next() is called by one at a time, off the I/O threads: it may wait for the disk.
class BodyStream {
public:
    BodyStream() = default;
    BodyStream(const BodyStream&) = delete;
    BodyStream& operator=(const BodyStream&) = delete;
    virtual ~BodyStream() = default;

    /// The next piece, empty at the end. An error ends the connection, so that whoever reads sees that the end is
    /// missing.
    [[nodiscard]] virtual Result<std::string> next() = 0;
};

} // namespace scanloom::http
