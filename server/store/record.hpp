#pragma once

#include "common/scan/log_entry.hpp"
#include "server/store/scan_log.hpp"

#include <optional>
#include <string>
#include <string_view>

/// The store's keys and values as bytes, format version 3.
///
///   key                                       value, followed by 4 bytes of checksum
///   'f'                                       format version, u64
///   'n'                                       id of the next session, u64
///   's' session:u64                           the session's record
///   'l' session:u64 revision:u64              one log entry
///   'c' session:u64 part:bytes                one part of the session's checkpoint
///
/// Numbers are big-endian, so that the order of keys is the order of sessions and revisions.
/// The checksum is the CRC-32C of key and value, little-endian.
///
/// Version 2 added packed ranges of scans (ScanTaken of log.proto); version 3 added exclusions (ScansExcluded,
/// ExclusionLifted) and the session setting max_jump. A program refuses stores of a later version than it knows,
/// because it could not read their entries or would compute other maps from them. Opening a store of an earlier version
/// upgrades it to this version; its entries stay as they are.
namespace scanloom::store {

inline constexpr std::uint64_t kFormatVersion = 4;
inline constexpr std::string_view kFormatKey = "f";
inline constexpr std::string_view kNextSessionKey = "n";
inline constexpr std::string_view kSessionsBegin = "s";
inline constexpr std::string_view kSessionsEnd = "t";
inline constexpr std::string_view kEntriesBegin = "l";
inline constexpr std::string_view kEntriesEnd = "m";

[[nodiscard]] std::string number_bytes(std::uint64_t number);
[[nodiscard]] std::optional<std::uint64_t> number_of(std::string_view bytes);

[[nodiscard]] std::string session_key(SessionId session);
[[nodiscard]] std::string entry_key(SessionId session, Revision revision);
[[nodiscard]] std::string part_key(SessionId session, std::string_view part);

/// First key of a session's entries or parts, and the key after the last.
struct KeyRange {
    std::string begin;
    std::string end;
};
[[nodiscard]] KeyRange entries_of(SessionId session);
[[nodiscard]] KeyRange parts_of(SessionId session);

/// Returns what a key names; nullopt for a key of another kind or length.
[[nodiscard]] std::optional<SessionId> session_of(std::string_view session_key);
[[nodiscard]] std::optional<Revision> revision_of(std::string_view entry_key);
[[nodiscard]] std::optional<std::string_view> part_of(std::string_view part_key);

/// Returns the session that a record, an entry or a part belongs to; nullopt for a key of another kind.
[[nodiscard]] std::optional<SessionId> owner_of(std::string_view key);

/// Returns a value followed by its checksum.
[[nodiscard]] std::string sealed(std::string_view key, std::string value);

/// Returns the value without its checksum; nullopt if the checksum does not match key and value.
[[nodiscard]] std::optional<std::string_view> unsealed(std::string_view key, std::string_view sealed_value);

} // namespace scanloom::store
