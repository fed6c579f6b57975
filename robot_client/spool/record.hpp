#pragma once

#include "common/error/error.hpp"
#include "common/wire/messages.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace scanloom::robot {

/// A record of a file of the spool is `uint32 length, uint32 CRC-32 of the body` (as of zlib; both big-endian), then
/// that many bytes of a Frame: a sensor description, or a batch of one scan whose seq is the scan's number within the
/// spool.
inline constexpr std::size_t kRecordHeaderBytes = 8;

void append_record(const wire::Message& message, std::string& out);

struct Record {
    wire::Message message;
    std::size_t bytes = 0; ///< of the file, header included
};

/// The record that `bytes` begins with; nothing where it is cut off, as the last one is after a power cut.
/// Errors  kMalformed: what stands there is no record, or a damaged one.
[[nodiscard]] Result<std::optional<Record>> read_record(std::string_view bytes);

} // namespace scanloom::robot
