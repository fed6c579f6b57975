#pragma once

#include "server/store/scan_log.hpp"
#include "tests/fault/simulation/world.hpp"
#include "tests/support/memory_scan_log.hpp"

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace scanloom::simulation {

/// The faults of a disk, until calm().
struct DiskTrouble {
    double failing = 0.0;   ///< share of the writes that fail, after which all fail until the store is reopened
    double full = 0.0;      ///< share of the writes that find the disk full, as do all others for some time
    double slow = 0.0;      ///< share of the writes that take seconds
    bool hasty = false;     ///< a lie: reports all data as durable before it is
    bool forgetful = false; ///< a lie: stores some data twice
};

/// A disk with a store, which outlives the programs that open it. After a crash it holds all acknowledged data, and
/// some of the oldest unacknowledged data.
class Disk {
public:
    Disk(World& world, const DiskTrouble& trouble) : world_(world), trouble_(trouble) {}
    Disk(const Disk&) = delete;
    Disk& operator=(const Disk&) = delete;

    /// Opens the store for one program. Errors  kStoreFailed: at random.
    [[nodiscard]] Result<std::unique_ptr<store::ScanLog>> open();

    /// Kills the program that has the store open: all its later calls fail.
    void crash();

    /// Ends all faults except the lies.
    void calm() noexcept { trouble_ = {.hasty = trouble_.hasty, .forgetful = trouble_.forgetful}; }
    /// Sets whether writes take no time.
    void set_at_once(bool at_once);

    [[nodiscard]] store::MemoryScanLog& durable() noexcept { return durable_; }

    /// Data that a hasty disk reported as durable and never stored.
    struct Dropped {
        store::SessionId session;
        std::vector<std::string> entries;
    };
    /// Returns the data dropped since the last call.
    [[nodiscard]] std::vector<Dropped> take_dropped() { return std::exchange(dropped_, {}); }

private:
    class OpenLog;
    struct Append {
        store::SessionId session;
        Revision first;
        std::vector<std::string> entries;
        store::ScanLog::Done done;
    };

    [[nodiscard]] bool try_to_open();
    void add(Append append);
    void commit();
    void store(Append& append);
    void drop(Append& append);
    void fail(const Error& why);
    [[nodiscard]] Result<> settle(bool adds);

    World& world_;
    DiskTrouble trouble_;
    store::MemoryScanLog durable_;
    std::vector<Append> waiting_;
    std::vector<Dropped> dropped_;
    std::uint64_t programs_ = 0; // number of programs that opened the store; the last one has it open now
    std::optional<Error> failed_;
    bool is_closed_ = false; // because it could not be reopened after it had failed
    Time full_until_{};
    std::uint64_t committing_ = 0; // number of the scheduled commit; 0: none
    std::uint64_t commits_ = 0;
    bool at_once_ = false;
};

} // namespace scanloom::simulation
