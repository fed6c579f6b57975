#pragma once

#include "common/error/error.hpp"
#include "server/store/damaged_store.hpp"

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

/// Repair of a store: what remains of its sessions is copied to a new one.
namespace scanloom::sessions {

/// Returns a unique name for each session of a repaired store.
///
/// A session keeps its name; session 7 becomes "session-7" if its record is lost or cannot be decoded. If several
/// sessions have the same name, because a removed one was recovered, the newest keeps it, and the ids are appended to
/// the others: "kitchen-7".
/// @param records  by id, as found by store::DamagedStore; nullopt: lost
[[nodiscard]] std::map<store::SessionId, std::string>
repaired_names(const std::map<store::SessionId, std::optional<std::string>>& records);

/// The result of repairing one session.
struct RepairedSession {
    std::string name;                   ///< see repaired_names()
    std::uint64_t kept = 0;             ///< entries copied to the new store
    std::uint64_t empty_scans = 0;      ///< lost scans that were replaced by empty ones; see LogReconstruction
    std::uint64_t missing = 0;          ///< lost entries between other entries; those lost at the end are unknown
    std::uint64_t lost_at_creation = 0; ///< lost entries with which the log began: parts of an imported map, the mode
    std::uint64_t set_aside = 0;        ///< entries in the file `aside`
    std::filesystem::path aside;        ///< empty: no such file
};

/// Copies the remaining entries of a session to another store. Entries that can no longer be applied are written to a
/// file in the directory `aside`, in the format of GET .../log: Protocol Buffers messages, each after its length.
///
/// @param record  nullopt: the record is lost; all entries are written to the file
/// @param name  of the session in the other store, and of the file
/// Errors: kStoreFailed if the new store or the file cannot be written; those of DamagedStore::read().
[[nodiscard]] Result<RepairedSession> repair_session(const store::DamagedStore& from, store::SessionId id,
                                                     const std::optional<std::string>& record, const std::string& name,
                                                     store::ScanLog& to, const std::filesystem::path& aside);

} // namespace scanloom::sessions
