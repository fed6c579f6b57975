#pragma once

#include "common/error/error.hpp"
#include "common/wire/messages.hpp"

#include <zlib.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace scanloom::robot {

/// Returns the CRC-32 (ISO-HDLC, as in gzip) of records and heads in spool files.
[[nodiscard]] inline std::uint32_t checksum(std::string_view bytes) {
    return static_cast<std::uint32_t>(
        ::crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size())));
}

/// A record in a spool file is `uint32 length, uint32 CRC-32 of the body` (as in zlib; both big-endian), followed by
/// that many bytes of a Frame: a sensor description, or a batch of one scan whose seq is the scan's number within the
/// spool.
inline constexpr std::size_t kRecordHeaderBytes = 8;

void append_record(const wire::Message& message, std::string& out);

struct Record {
    wire::Message message;
    std::size_t bytes = 0; ///< in the file, including the header
};

/// Reads the record at the beginning of `bytes`, or returns nullopt if it is truncated, as the last one is after a
/// power failure.
/// Errors: kMalformed if the bytes are not a record or are damaged.
[[nodiscard]] Result<std::optional<Record>> read_record(std::string_view bytes);

} // namespace scanloom::robot
