#pragma once

#include "common/error/error.hpp"
#include "server/session/read_rate.hpp"
#include "server/session/session_registry.hpp"
#include "server/store/scan_log.hpp"

#include <boost/asio/any_io_executor.hpp>

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>

namespace scanloom::session {

/// Checks the sessions that were not loaded at startup, one after another, and reports the damaged ones.
///
/// Without it, the damage of a session is found only when a client requests the session. Checks with CheckDepth::kLog:
/// entries are read and decoded, and no map is computed.
/// Threads: any thread.
class BackgroundCheck {
public:
    static constexpr double kBytesPerSecond = 50e6; ///< leaves disk time for the writes of robots' scans

    /// The log, the registry and the executor must outlive this object.
    ///
    /// @param checking  runs the check, which blocks; must not be used for anything else
    /// @param bytes_per_second  bound of the read rate
    BackgroundCheck(store::ScanLog& log, const SessionRegistry& sessions, boost::asio::any_io_executor checking,
                    double bytes_per_second = kBytesPerSecond);

    /// Starts checking the sessions that are not in memory at this time. Call once, after SessionRegistry::recover().
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
    [[nodiscard]] Result<> go_on_after(std::size_t bytes);
    [[nodiscard]] bool is_still_there(const std::string& name, store::SessionId id) const;

    store::ScanLog& log_;
    const SessionRegistry& sessions_;
    const boost::asio::any_io_executor checking_;
    ReadRate rate_;            // used by the checking thread only
    mutable std::mutex mutex_; // guards the members below
    mutable std::condition_variable changed_;
    bool stopped_ = false;
    bool done_ = false;
    std::uint64_t checked_ = 0;
    std::map<std::string, Damaged> damaged_;
    std::chrono::steady_clock::time_point next_warning_{};
};

} // namespace scanloom::session
