#pragma once

#include "server/store/scan_log.hpp"

#include <functional>
#include <set>
#include <string_view>

/// Block scan: finds what is intact in a RocksDB table file whose index, footer or blocks are damaged, without using
/// them.
namespace scanloom::store {

/// Receives a session's record or a log entry with a valid checksum. Both arguments are valid during the call only.
using VisitCarved = std::function<void(std::string_view key, std::string_view sealed_value)>;

/// Checks at every byte of a table whether a record or an entry begins there, and visits each intact one once. An entry
/// stores only the part of its key that differs from the previous key. The key of an entry behind a damaged one is
/// therefore derived from the last intact key or from the next one, and accepted if the checksum of key and value
/// matches.
///
/// Removals are not visited: the caller has to know what was removed since.
///
/// Shapes: an entry is shared:varint32 not_shared:varint32 value_length:varint32 key_rest value; its key ends with
///         type:u8 sequence:u56. Blocks must be uncompressed, as the store's are.
/// Source: RocksDB 7.8, table/block_based/block_builder.cc, db/dbformat.h.
void carve_table(std::string_view table, const VisitCarved& visit);

/// Returns the sessions whose records a table removes. No checksum covers a removal.
/// Pre: the table is intact (check_table()).
[[nodiscard]] std::set<SessionId> sessions_removed_in(std::string_view table);

} // namespace scanloom::store
