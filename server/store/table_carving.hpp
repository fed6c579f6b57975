#pragma once

#include "server/store/scan_log.hpp"

#include <functional>
#include <set>
#include <string_view>

/// What is left in a table file of RocksDB whose index, footer or blocks are damaged, found without them.
namespace scanloom::store {

/// A session's record or a log entry whose checksum holds; both are valid during the call only.
using VisitCarved = std::function<void(std::string_view key, std::string_view sealed_value)>;

/// Looks at every byte of a table whether a record or an entry begins there, and tells those that are intact, each
/// once. An entry says only in what its key differs from the one before, so of one behind a damaged entry the key is
/// made from that of the last intact one, or of the next. It is believed where the checksum of key and value holds.
///
/// Removals are not told here: whoever takes what is found has to know what was removed since.
///
/// Shapes  an entry is shared:varint32 not_shared:varint32 value_length:varint32 key_rest value; its key ends with
///         type:u8 sequence:u56. Blocks have to be uncompressed, as the store's are.
/// Source  RocksDB 7.8, table/block_based/block_builder.cc, db/dbformat.h.
void carve_table(std::string_view table, const VisitCarved& visit);

/// The sessions whose records a table removes. Of a removal no checksum tells that it was one.
/// Pre  the table is whole (check_table()).
[[nodiscard]] std::set<SessionId> sessions_removed_in(std::string_view table);

} // namespace scanloom::store
