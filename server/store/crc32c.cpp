#include "server/store/crc32c.hpp"

#include <boost/crc.hpp>

namespace scanloom::store {

std::uint32_t crc32c(std::string_view head, std::string_view tail) {
    boost::crc_optimal<32, 0x1EDC6F41, 0xFFFFFFFF, 0xFFFFFFFF, true, true> crc;
    crc.process_bytes(head.data(), head.size());
    crc.process_bytes(tail.data(), tail.size());
    return crc.checksum();
}

} // namespace scanloom::store
