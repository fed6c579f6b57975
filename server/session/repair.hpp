#pragma once

#include "common/error/error.hpp"
#include "server/store/salvage.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace scanloom::session {

/// What became of a session's log.
struct RepairedSession {
    std::string name;            ///< see repaired_names()
    std::uint64_t kept = 0;      ///< entries
    std::uint64_t stood_in = 0;  ///< scans that are lost, see Rescue
    std::uint64_t missing = 0;   ///< entries between others that are nowhere; what is lost of the end cannot be told
    std::uint64_t set_aside = 0; ///< entries that are intact and cannot be woven, in `aside`
    std::filesystem::path aside; ///< empty: there are none
};

/// Writes what is left of a session into another store, and what cannot be woven any more into a file of the directory
/// `aside`, as GET .../log has it: entries in Protocol Buffers, each behind its length.
/// @param record  nothing: it is lost, and all entries are set aside.
/// @param name    in the other store, and of the file.
/// Errors  kStoreFailed: the new store, or the file, cannot be written.
[[nodiscard]] Result<RepairedSession> repair_session(const store::Salvage& from, store::SessionId id,
                                                     const std::optional<std::string>& record, const std::string& name,
                                                     store::ScanLog& to, const std::filesystem::path& aside);

} // namespace scanloom::session
