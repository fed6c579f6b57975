#pragma once

#include "common/error/error.hpp"

#include <string>

namespace scanloom::http {

/// A response body that is produced in pieces while it is sent, for content that may exceed the memory.
/// Threads: one caller of next() at a time, not on an I/O thread because it may wait for the disk.
class BodyStream {
public:
    BodyStream() = default;
    BodyStream(const BodyStream&) = delete;
    BodyStream& operator=(const BodyStream&) = delete;
    virtual ~BodyStream() = default;

    /// Returns the next piece, empty at the end. After an error the connection closes, so that the client detects that
    /// the body is incomplete.
    [[nodiscard]] virtual Result<std::string> next() = 0;
};

} // namespace scanloom::http
