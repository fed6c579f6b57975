#pragma once

#include "common/error/error.hpp"
#include "common/limits/token_bucket.hpp"
#include "server/sessions/session_registry.hpp"
#include "server/store/scan_log.hpp"

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <thread>

namespace scanloom::sessions {

/// Checks the sessions that were not loaded at startup, one after another, and reports the damaged ones.
///
/// Without it, the damage of a session is found only when a client requests the session. Checks with CheckDepth::kLog:
/// entries are read and decoded, and no map is computed.
/// Threads: any thread.
class BackgroundCheck {
public:
    static constexpr double kBytesPerSecond = 50e6; ///< leaves disk time for the writes of robots' scans

    /// The log and the registry must outlive this object.
    ///
    /// @param bytes_per_second  bound of the read rate
    BackgroundCheck(store::ScanLog& log, const SessionRegistry& sessions, double bytes_per_second = kBytesPerSecond);

    /// Stops the check and waits for its thread.
    ~BackgroundCheck();

    /// Starts checking the sessions that are not in memory at this time, on a thread of its own with the lowest
    /// priority that ends with the check. Call once, after SessionRegistry::recover(). Throws std::system_error if the
    /// system cannot create the thread.
    void start();

    /// Ends the check at its next entry. It cannot be started again.
    void stop();

    /// Records that another reader failed to read the log of a session.
    ///
    /// @param why  kDataLoss marks the session as damaged; other errors are only logged
    void note(store::SessionId id, const Error& why);

    /// Returns the damaged sessions that still exist, with the reason for each, by name. The parts of these sessions
    /// that can be read are still served.
    [[nodiscard]] std::map<std::string, Error> damaged() const;

    /// Returns the number of sessions that were checked to their end.
    [[nodiscard]] std::uint64_t checked() const;

    /// Waits until all sessions are checked or stop() was called.
    void wait() const;

private:
    struct Damaged {
        store::SessionId id = 0;
        Error why;
    };

    void run();
    void check(const store::StoredSession& stored, const std::string& name);
    void keep(const std::string& name, store::SessionId id, const Error& why);
    [[nodiscard]] Result<> pause_after(std::size_t bytes);
    [[nodiscard]] bool is_still_there(const std::string& name, store::SessionId id) const;

    store::ScanLog& log_;
    const SessionRegistry& sessions_;
    limits::TokenBucket read_rate_; // used by the checking thread only
    mutable std::mutex mutex_;      // guards the members below
    mutable std::condition_variable changed_;
    bool stopped_ = false;
    bool done_ = false;
    std::uint64_t checked_ = 0;
    std::map<std::string, Damaged> damaged_;
    std::chrono::steady_clock::time_point next_warning_{};
    std::thread thread_;
};

} // namespace scanloom::sessions
