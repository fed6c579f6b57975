#pragma once

#include "server/store/scan_log.hpp"
#include "tests/fault/simulation/world.hpp"
#include "tests/support/memory_scan_log.hpp"

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace scanloom::simulation {

/// What a disk does wrong, until the world is calm.
struct DiskTrouble {
    double failing = 0.0;   ///< of the writes: fail, after which all do until the store is opened again
    double full = 0.0;      ///< of the writes: find the disk full, as do all for a while
    double slow = 0.0;      ///< of the writes: take seconds
    bool hasty = false;     ///< a lie: says of everything that it is durable before it is
    bool forgetful = false; ///< a lie: stores some of it twice
};

/// A disk with a store on it, which outlives the programs that open it.
/// What a crash leaves is all that was acknowledged, and of what was not some of the oldest.
class Disk {
public:
    Disk(World& world, const DiskTrouble& trouble) : world_(world), trouble_(trouble) {}
    Disk(const Disk&) = delete;
    Disk& operator=(const Disk&) = delete;

    /// The store, for one program. Errors  kStoreFailed: now and then.
    [[nodiscard]] Result<std::unique_ptr<store::ScanLog>> open();

    /// The program that has it open is killed: whatever it still tries fails.
    void crash();

    /// From now on everything works, and takes no time where `at_once`.
    void calm() noexcept { trouble_ = {.hasty = trouble_.hasty, .forgetful = trouble_.forgetful}; }
    void set_at_once(bool at_once);

    [[nodiscard]] store::MemoryScanLog& durable() noexcept { return durable_; }

    /// What a hasty disk called durable and never stored.
    struct Dropped {
        store::SessionId session;
        std::vector<std::string> entries;
    };
    /// All since the last call.
    [[nodiscard]] std::vector<Dropped> take_dropped() { return std::exchange(dropped_, {}); }

private:
    class OpenLog;
    struct Append {
        store::SessionId session;
        Revision first;
        std::vector<std::string> entries;
        store::ScanLog::Done done;
    };

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
    std::uint64_t programs_ = 0; // that had it open; the last one has it now
    std::optional<Error> failed_;
    Time full_until_{};
    std::uint64_t committing_ = 0; // number of the commit that is planned; 0: none is
    std::uint64_t commits_ = 0;
    bool at_once_ = false;
};

} // namespace scanloom::simulation
