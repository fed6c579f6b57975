#pragma once

#include "common/error/error.hpp"
#include "server/store/salvaged_tables.hpp"
#include "server/store/scan_log.hpp"

#include <rocksdb/options.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace scanloom::store {

/// Reads the intact sessions and log entries of a damaged store. Checkpoints are ignored, because maps are computed
/// again from the log.
///
/// A session that was deleted shortly before the damage may reappear if tables are missing or cannot be opened.
/// Threads: one.
class Salvage {
public:
    /// @param copy  see SalvagedTables::open()
    /// Errors: kNotFound: there is no store; kConflict: a server has it open; kStoreFailed: as for
    ///         SalvagedTables::open().
    [[nodiscard]] static Result<std::unique_ptr<Salvage>>
    open(const std::filesystem::path& store, const std::filesystem::path& copy, const StoreOptions& options = {});

    /// Returns the records by session id; nullopt for a session that has entries but no intact record.
    [[nodiscard]] const std::map<SessionId, std::optional<std::string>>& sessions() const noexcept { return sessions_; }

    using VisitEntry = std::function<Result<>(Revision, std::string_view)>;

    /// Visits the intact entries of a session's log by ascending revision; entries between them are lost. Stops at the
    /// visitor's error.
    /// @return number of entries with a wrong checksum
    [[nodiscard]] Result<std::uint64_t> read(SessionId session, const VisitEntry& visit) const;

    [[nodiscard]] const SalvagedTables& tables() const noexcept { return *tables_; }

private:
    Salvage(std::unique_ptr<SalvagedTables> tables, const StoreOptions& options);
    void find_sessions();
    void find_records(const SalvagedTables::Table& table);
    void find_owners(const SalvagedTables::Table& table);

    const std::unique_ptr<SalvagedTables> tables_;
    const rocksdb::Options options_; // for a table that is read by itself
    std::map<SessionId, std::optional<std::string>> sessions_;
};

} // namespace scanloom::store
