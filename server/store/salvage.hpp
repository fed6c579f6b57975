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

/// What can still be read of a store, however damaged: its sessions and the entries of their logs. Checkpoints are
/// left: maps are woven anew.
///
/// A session that was deleted shortly before may come back where tables are missing or cannot be opened.
/// Thread  one.
class Salvage {
public:
    /// @param copy  see SalvagedTables::open
    /// Errors  kNotFound, kConflict (a server has it open), kStoreFailed: as SalvagedTables::open.
    [[nodiscard]] static Result<std::unique_ptr<Salvage>>
    open(const std::filesystem::path& store, const std::filesystem::path& copy, const StoreOptions& options = {});

    /// By id; nothing: of this session there are entries, but no intact record.
    [[nodiscard]] const std::map<SessionId, std::optional<std::string>>& sessions() const noexcept { return sessions_; }

    using VisitEntry = std::function<Result<>(Revision, std::string_view)>;

    /// The intact entries of a session's log, by rising revision; those between them are lost. Stops at the visitor's
    /// error. @return how many were found whose checksum does not hold.
    [[nodiscard]] Result<std::uint64_t> read(SessionId session, const VisitEntry& visit) const;

    [[nodiscard]] const SalvagedTables& tables() const noexcept { return *tables_; }

private:
    Salvage(std::unique_ptr<SalvagedTables> tables, const StoreOptions& options);
    void find_sessions();
    void find_records(const SalvagedTables::Table& table);
    void find_owners(const SalvagedTables::Table& table);

    const std::unique_ptr<SalvagedTables> tables_;
    const rocksdb::Options options_; // of a table that is read by itself
    std::map<SessionId, std::optional<std::string>> sessions_;
};

} // namespace scanloom::store
