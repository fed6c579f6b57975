#include "server/store/log_file.hpp"

#include "common/hash/crc32c.hpp"

#include <boost/endian/conversion.hpp>

#include <algorithm>
#include <cstdint>

namespace scanloom::store {
namespace {

constexpr std::size_t kBlockBytes = 32768;
constexpr std::size_t kHeaderBytes = 7;
constexpr std::size_t kSectorBytes = 512; // smallest unit that a disk writes

enum RecordType : unsigned char { kFull = 1, kFirst = 2, kMiddle = 3, kLast = 4 };

bool is_start(unsigned char type) { return type == kFull || type == kFirst; }
bool is_end(unsigned char type) { return type == kFull || type == kLast; }

/// A record's header as read, valid or not.
struct Header {
    std::uint32_t checksum;
    std::size_t length;
    unsigned char type;
};

std::size_t left_in_block(std::size_t at) { return kBlockBytes - at % kBlockBytes; }

std::optional<Header> header_at(std::string_view bytes, std::size_t at) {
    if (left_in_block(at) < kHeaderBytes || bytes.size() - at < kHeaderBytes) return std::nullopt;
    const auto* raw = reinterpret_cast<const unsigned char*>(bytes.data() + at);
    return Header{boost::endian::load_little_u32(raw), boost::endian::load_little_u16(raw + 4), raw[6]};
}

/// The file stores checksums rotated, because checksums of data that contains checksums would be weak.
std::uint32_t unmasked(std::uint32_t masked) {
    const std::uint32_t rotated = masked - 0xa282ead8U;
    return (rotated >> 17) | (rotated << 15);
}

/// Whether `length` bytes of payload match the header's checksum, which also covers the type.
bool matches(const Header& header, std::string_view bytes, std::size_t at, std::size_t length) {
    return unmasked(header.checksum) == crc32c(bytes.substr(at + kHeaderBytes - 1, 1 + length));
}

/// Returns the header of an intact record at `at`.
std::optional<Header> record_at(std::string_view bytes, std::size_t at) {
    const auto header = header_at(bytes, at);
    if (!header || header->type < kFull || header->type > kLast) return std::nullopt;
    if (kHeaderBytes + header->length > std::min(left_in_block(at), bytes.size() - at)) return std::nullopt;
    if (!matches(*header, bytes, at, header->length)) return std::nullopt;
    return header;
}

/// Whether another write begins at or after `at`. Checks every byte, because a damaged length hides the next record.
bool write_begins_after(std::string_view bytes, std::size_t at) {
    for (; at + kHeaderBytes <= bytes.size(); ++at) {
        if (!is_start(static_cast<unsigned char>(bytes[at + kHeaderBytes - 1]))) continue;
        if (record_at(bytes, at)) return true;
    }
    return false;
}

/// Whether any sector from `at` on was never written; of the first sector, only the rest counts.
bool has_unwritten_sector(std::string_view bytes, std::size_t at) {
    while (at < bytes.size()) {
        const std::size_t left_in_sector = kSectorBytes - at % kSectorBytes;
        if (bytes.substr(at, left_in_sector).find_first_not_of('\0') == std::string_view::npos) return true;
        at += left_in_sector;
    }
    return false;
}

/// Whether the end of the file cuts off the record at `at`.
bool is_cut_off(std::string_view bytes, std::size_t at) {
    const auto header = header_at(bytes, at);
    if (!header) return true;
    if (header->type > kLast) return false; // a crash leaves either the header or zeros
    const std::size_t present = bytes.size() - at - kHeaderBytes;
    if (header->length <= present || kHeaderBytes + header->length > left_in_block(at)) return false;
    return !matches(*header, bytes, at, present); // if they match, the payload is complete and only its length is wrong
}

} // namespace

LogFileCheck check_log_file(std::string_view bytes) {
    LogFileCheck check;
    bool inside_write = false;
    std::size_t at = 0;
    while (at < bytes.size()) {
        if (left_in_block(at) < kHeaderBytes) { // too short for a header: padding
            at += left_in_block(at);
            continue;
        }
        const auto record = record_at(bytes, at);
        if (!record || is_start(record->type) == inside_write) {
            const bool torn = !record && !write_begins_after(bytes, at + 1) &&
                              (is_cut_off(bytes, at) || has_unwritten_sector(bytes, at));
            if (!torn) check.damage = at;
            return check;
        }
        at += kHeaderBytes + record->length;
        inside_write = !is_end(record->type);
        if (!inside_write) check.whole_bytes = at;
    }
    return check;
}

std::vector<std::string> whole_writes_of(std::string_view bytes) {
    std::vector<std::string> writes;
    std::string write; // the first records of the current write
    bool inside_write = false;
    std::size_t at = 0;
    while (at < bytes.size()) {
        if (left_in_block(at) < kHeaderBytes) {
            at += left_in_block(at);
            continue;
        }
        const auto record = record_at(bytes, at);
        if (!record) {
            inside_write = false;
            ++at; // a damaged length hides the next record
            continue;
        }
        if (is_start(record->type)) write.clear();
        inside_write = is_start(record->type) || inside_write;
        if (inside_write) write.append(bytes.substr(at + kHeaderBytes, record->length));
        if (inside_write && is_end(record->type)) {
            writes.push_back(std::move(write));
            write.clear();
            inside_write = false;
        }
        at += kHeaderBytes + record->length;
    }
    return writes;
}

} // namespace scanloom::store
