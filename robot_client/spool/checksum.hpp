#pragma once

#include <zlib.h>

#include <cstdint>
#include <string_view>

namespace scanloom::robot {

/// Returns the CRC-32 (ISO-HDLC, as in gzip) of records and heads in spool files.
[[nodiscard]] inline std::uint32_t checksum(std::string_view bytes) {
    return static_cast<std::uint32_t>(
        ::crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size())));
}

} // namespace scanloom::robot
