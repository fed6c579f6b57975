#include "server/store/record.hpp"

#include "common/hash/crc32c.hpp"

#include <boost/endian/conversion.hpp>

namespace scanloom::store {
namespace {

constexpr char kSession = 's';
constexpr char kEntry = 'l';
constexpr char kPart = 'c';
constexpr std::size_t kNumberBytes = 8;
constexpr std::size_t kChecksumBytes = 4;

std::string key_of(char kind, SessionId session) { return kind + number_bytes(session); }

} // namespace

std::string number_bytes(std::uint64_t number) {
    unsigned char bytes[kNumberBytes];
    boost::endian::store_big_u64(bytes, number);
    return {reinterpret_cast<const char*>(bytes), kNumberBytes};
}

std::optional<std::uint64_t> number_of(std::string_view bytes) {
    if (bytes.size() != kNumberBytes) return std::nullopt;
    return boost::endian::load_big_u64(reinterpret_cast<const unsigned char*>(bytes.data()));
}

std::string session_key(SessionId session) { return key_of(kSession, session); }

std::string entry_key(SessionId session, Revision revision) { return key_of(kEntry, session) + number_bytes(revision); }

std::string part_key(SessionId session, std::string_view part) { return key_of(kPart, session).append(part); }

KeyRange entries_of(SessionId session) { return {key_of(kEntry, session), key_of(kEntry, session + 1)}; }

KeyRange parts_of(SessionId session) { return {key_of(kPart, session), key_of(kPart, session + 1)}; }

std::optional<SessionId> session_of(std::string_view session_key) {
    if (!session_key.starts_with(kSession)) return std::nullopt;
    return number_of(session_key.substr(1));
}

std::optional<Revision> revision_of(std::string_view entry_key) {
    if (!entry_key.starts_with(kEntry) || entry_key.size() != 1 + 2 * kNumberBytes) return std::nullopt;
    return number_of(entry_key.substr(1 + kNumberBytes));
}

std::optional<std::string_view> part_of(std::string_view part_key) {
    if (!part_key.starts_with(kPart) || part_key.size() < 1 + kNumberBytes) return std::nullopt;
    return part_key.substr(1 + kNumberBytes);
}

std::optional<SessionId> owner_of(std::string_view key) {
    if (key.empty() || (key[0] != kSession && key[0] != kEntry && key[0] != kPart)) return std::nullopt;
    return number_of(key.substr(1, kNumberBytes));
}

std::string sealed(std::string_view key, std::string value) {
    unsigned char checksum[kChecksumBytes];
    boost::endian::store_little_u32(checksum, crc32c(key, value));
    value.append(reinterpret_cast<const char*>(checksum), kChecksumBytes);
    return value;
}

std::optional<std::string_view> unsealed(std::string_view key, std::string_view sealed_value) {
    if (sealed_value.size() < kChecksumBytes) return std::nullopt;
    const auto value = sealed_value.substr(0, sealed_value.size() - kChecksumBytes);
    const auto* checksum = reinterpret_cast<const unsigned char*>(value.data() + value.size());
    if (boost::endian::load_little_u32(checksum) != crc32c(key, value)) return std::nullopt;
    return value;
}

} // namespace scanloom::store
