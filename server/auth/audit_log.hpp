#pragma once

#include "common/net/tls.hpp"
#include "server/auth/token.hpp"

#include <prometheus/counter.h>
#include <prometheus/registry.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

namespace scanloom::auth {

/// Returns the time of a monotonic clock, in seconds.
[[nodiscard]] double steady_seconds();

/// The port on which a refusal happened.
enum class Port { kRobot, kHttp };

inline constexpr std::array kPorts = {Port::kRobot, Port::kHttp};

[[nodiscard]] constexpr std::string_view name_of(Port port) noexcept { return port == Port::kRobot ? "robot" : "http"; }

/// One refused connection or request.
struct Refusal {
    Port port = Port::kRobot;
    Reason reason = Reason::kNoToken;
    std::string who;     ///< address, without a port
    std::string token;   ///< the token's name; empty: not known
    std::string session; ///< as the client sent it, not validated; empty: none

    friend bool operator==(const Refusal&, const Refusal&) = default;
};

/// Limits the log lines about refusals, so that refused clients cannot fill the log. For each address, port and reason
/// the first refusal is reported at once, and later ones in at most one line per minute with their count.
///
/// Bounds: kEntriesMax entries, each for one address, port and reason. When they are used up, refusals of further
/// combinations are counted in one additional entry for each port and reason, with the address kOthers.
/// All times are in seconds of a monotonic clock.
class RefusalTable {
public:
    static constexpr std::size_t kEntriesMax = 1024; ///< without those of kOthers
    static constexpr double kPauseSeconds = 60.0;
    static constexpr std::string_view kOthers = "others";

    /// A log line about refusals with the same address, port and reason.
    struct Line {
        Refusal newest;
        std::uint64_t count = 0; ///< since the last line

        friend bool operator==(const Line&, const Line&) = default;
    };

    /// Records a refusal.
    /// @return the lines to log now
    [[nodiscard]] std::vector<Line> note(Refusal refusal, double now);

    /// Returns the lines that are due. Call it periodically, so that they appear even if no further refusal occurs.
    [[nodiscard]] std::vector<Line> due(double now);

    /// Returns the lines that have not been reported. Call it before destruction.
    [[nodiscard]] std::vector<Line> rest();

private:
    using Key = std::tuple<std::string, Port, Reason>;
    struct Kept {
        Refusal newest;
        double logged = 0.0;        // time of the last line
        std::uint64_t unlogged = 0; // refusals since then
    };

    void sweep(double now, std::vector<Line>& lines);

    std::map<Key, Kept> kept_;
    double swept_ = 0.0;
};

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
