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

/// Reads the sessions that a start left in the store, one after another, and tells which of them are damaged: nobody
/// would know before somebody asks for them. Entries are read and decoded as by CheckDepth::kLog, and nothing is woven.
/// Thread  any.
class BackgroundCheck {
public:
    static constexpr double kBytesPerSecond = 50e6; ///< so that robots' writes do not wait for the disk

    /// @param checking  where it runs, and waits: an executor of its own. All must outlive this.
    BackgroundCheck(store::ScanLog& log, const SessionRegistry& sessions, boost::asio::any_io_executor checking,
                    double bytes_per_second = kBytesPerSecond);

    /// Begins with what is asleep now. To be called once, after SessionRegistry::recover().
    void start();

    /// Has it end at its next entry, for good.
    void stop();

    /// Somebody else could not read the log of this session: kDataLoss is damage from now on, other reasons are logged.
    void note(store::SessionId id, const Error& why);

    /// What was found and is still there: name and reason. These sessions are served as far as they can be.
    [[nodiscard]] std::map<std::string, Error> damaged() const;

    /// Sessions that have been read to their end.
    [[nodiscard]] std::uint64_t checked() const;

    /// Waits until all have been, or stop().
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
    ReadRate rate_;            // the check's own
    mutable std::mutex mutex_; // guards what follows
    mutable std::condition_variable changed_;
    bool stopped_ = false;
    bool done_ = false;
    std::uint64_t checked_ = 0;
    std::map<std::string, Damaged> damaged_;
    std::chrono::steady_clock::time_point next_warning_{};
};

} // namespace scanloom::session
