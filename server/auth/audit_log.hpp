#pragma once

#include "common/net/tls.hpp"
#include "server/auth/refusals.hpp"

#include <prometheus/counter.h>
#include <prometheus/registry.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>

namespace scanloom::auth {

/// Returns the time of a monotonic clock, in seconds.
[[nodiscard]] double steady_seconds();

/// Counters of refused connections and requests on both ports.
/// Threads: any thread.
class RefusalCounters {
public:
    explicit RefusalCounters(prometheus::Registry& registry);

    [[nodiscard]] prometheus::Counter& of(Port port, Reason reason) const {
        return *counters_[static_cast<std::size_t>(port)][static_cast<std::size_t>(reason)];
    }

private:
    std::array<std::array<prometheus::Counter*, kReasons.size()>, kPorts.size()> counters_{};
};

/// The audit log: counts refusals and logs them. It never receives secrets.
///
/// A line reads: event=refused port=robot who=10.0.0.7 token=depot reason=wrong_session session=lab count=1
/// Threads: any thread.
class AuditLog {
public:
    /// @param registry  to which the counters are added
    /// @param now  a monotonic clock, in seconds
    explicit AuditLog(prometheus::Registry& registry, std::function<double()> now = steady_seconds)
        : counters_(registry), now_(std::move(now)) {}

    /// Logs the refusals that were not logged yet.
    ~AuditLog();
    AuditLog(const AuditLog&) = delete;
    AuditLog& operator=(const AuditLog&) = delete;

    /// Counts the refusal, and logs it as RefusalTable allows.
    void note(Refusal refusal);

    /// Counts and logs a client without a valid certificate.
    /// @param who  the client's address, without a port
    void note(Port port, const std::string& who, net::ClientFault fault);

    [[nodiscard]] const RefusalCounters& counters() const noexcept { return counters_; }

    /// Logs the lines that are due. Call it periodically.
    void log_due();

    /// Decides whether to log the end of a connection that was never admitted. At most one per second is logged, so
    /// that such connections cannot fill the disk.
    /// @return how many were not logged since the last line, or nullopt if this one is not to be logged either
    [[nodiscard]] std::optional<std::uint64_t> admit_log_line();

private:
    RefusalCounters counters_;
    std::function<double()> now_;
    std::mutex mutex_; // guards the following members
    RefusalTable table_;
    std::optional<double> stranger_logged_; // time of the last such line
    std::uint64_t strangers_unlogged_ = 0;  // connections since then
};

} // namespace scanloom::auth
