#pragma once

#include "common/error/error.hpp"
#include "server/store/postgres_connection.hpp"

/// The tables of the store in a database, format 1, in the schema `scanloom`:
///
///   meta     key, value: the format
///   session  id, record, owner and epoch (who may write it), end_rev (its last entry), removed
///   segment  session, first, last, body: entries of its log, see postgres_segments.hpp
///   part     session, key, value: parts of its checkpoint
///
/// An append takes effect only where `epoch` is the writer's: a server that was paused while another one took its
/// sessions over changes nothing.
namespace scanloom::store::postgres {

inline constexpr int kFormat = 1;

/// Creates the tables if they do not exist.
/// Errors: kUnsupportedVersion: a newer program wrote them; kStoreFailed.
[[nodiscard]] Result<> create_tables(Connection& connection);

/// Checks that the tables exist, in a format that this program reads.
/// Errors: kNotFound: there are none; kUnsupportedVersion: a newer program wrote them; kStoreFailed.
[[nodiscard]] Result<> check_tables(Connection& connection);

} // namespace scanloom::store::postgres
