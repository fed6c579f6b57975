#pragma once

#include "server/store/scan_log.hpp"
#include "tests/fault/verification.hpp"
#include "tests/support/temporary_directory.hpp"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace scanloom::fault {

/// A store and its contents.
struct OriginalStore {
    std::string what; ///< description of its files
    std::filesystem::path path;
    std::map<std::string, Held> sessions;
};

/// The same store at four moments, with its data in different files. Written one entry after the other, so that the
/// same files result each time, except for names that RocksDB chooses.
class OriginalStores {
public:
    static constexpr std::uint64_t kScans = 300; ///< of each session, at the last moment
    static constexpr std::uint64_t kSessions = 3;

    OriginalStores();

    [[nodiscard]] const std::vector<OriginalStore>& all() const noexcept { return stores_; }

private:
    void create_sessions(store::ScanLog& log);
    void append_scans(store::ScanLog& log, std::uint64_t count);
    void write_checkpoints(store::ScanLog& log) const;
    void keep(std::string what);

    TemporaryDirectory place_;
    std::map<std::string, Held> sessions_; // current state
    std::vector<OriginalStore> stores_;
};

} // namespace scanloom::fault
