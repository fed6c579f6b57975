#pragma once

#include "common/error/error.hpp"
#include "server/store/postgres_connection.hpp"

#include <string>

/// The tables of the store in a database, format 2, in the schema `scanloom`:
///
///   meta     key, value: the format, and a secret that only the servers know
///   node     id, name, robots and http (its addresses), build, seen (when it last said that it runs): the servers that
///            use the store
///   session  id, record, name and replaces (what the record says), owner (a node; 0: none) and epoch (who may write
///            it), end_rev (its last entry), entry_bytes and checkpoint_bytes (what its rows in the next two tables
///            contain), removed
///   segment  session, first, last, body: entries of its log, see postgres_segments.hpp
///   part     session, key, value: parts of its checkpoint
///
/// An append takes effect only where `epoch` is the writer's: a server that was paused while another one took its
/// sessions over changes nothing. Names are unique among sessions that are not removed. A copy that is to replace a
/// session has no name before that session is removed.
///
/// Format 1 had neither nodes nor names, and one server at a time.
namespace scanloom::store::postgres {

inline constexpr int kFormat = 2;

/// Creates the tables if they do not exist, and brings those of an earlier format up to date.
/// Errors: those of check_tables() but kNotFound.
[[nodiscard]] Result<> create_tables(Connection& connection);

/// Creates the tables of a store that is unfinished until finish_store(); removes those that an earlier, unfinished
/// copy left.
/// Errors: kConflict: there is a store; kUnsupportedVersion, kStoreFailed.
[[nodiscard]] Result<> begin_unfinished_store(Connection& connection);

/// Makes a store of begin_unfinished_store() one that can be opened.
[[nodiscard]] Result<> finish_store(Connection& connection);

/// Returns the secret of the servers that share the store.
[[nodiscard]] Result<std::string> read_secret(Connection& connection);

/// Checks that the tables exist, in a format that this program reads.
/// Errors: kNotFound: there are none; kUnsupportedVersion: a newer program wrote them; kStoreFailed: a copy has not
///         finished writing them, or the database cannot be used.
[[nodiscard]] Result<> check_tables(Connection& connection);

} // namespace scanloom::store::postgres
