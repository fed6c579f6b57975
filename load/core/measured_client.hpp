#pragma once

#include "common/link/client_protocol.hpp"
#include "common/link/scan_queue.hpp"
#include "common/wire/messages.hpp"
#include "load/core/figures.hpp"
#include "load/core/micros.hpp"
#include "load/core/workload.hpp"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>

namespace scanloom::load {

/// One robot of many.
struct RobotPlan {
    std::uint32_t index = 0; ///< among all robots
    std::string session;
    std::string name;           ///< within the session
    std::size_t first_scan = 0; ///< its first scan in the workload
};

/// The scans of one robot of a workload. They need no memory: each is generated again when it is sent.
class WorkloadQueue final : public link::ScanQueue {
public:
    /// `workload` must outlive this object.
    WorkloadQueue(const Workload& workload, std::size_t first_scan) : workload_(&workload), first_scan_(first_scan) {}

    void set_last(std::uint64_t seq) noexcept { last_ = seq; }

    [[nodiscard]] std::uint64_t last() const noexcept override { return last_; }
    [[nodiscard]] const std::shared_ptr<const Sensor>& sensor(std::uint64_t) const override {
        return workload_->sensor;
    }
    [[nodiscard]] std::size_t beams(std::uint64_t) const override { return workload_->beams; }
    [[nodiscard]] std::size_t bytes_max(std::uint64_t seq) const override;
    void append_batch(std::uint64_t first, std::size_t count, std::string& out) const override;

private:
    void renumber(std::uint64_t first) override { last_ = first - 1; }
    void drop_until(std::uint64_t) override {}

    const Workload* workload_;
    std::size_t first_scan_;
    std::uint64_t last_ = 0;
};

/// The robot's side of the robot link for one of thousands of robots: a link::ClientProtocol, and statistics of what it
/// sends and receives.
///
/// Usage: link up: open(); for received bytes: prepare(), on_bytes(); after each event write(), and send its output;
/// link down: close(). As time passes: due(). After the last scan: end().
/// Threads: one at a time.
class MeasuredClient {
public:
    static constexpr std::size_t kWriteMax = std::size_t{64} << 10; ///< bytes of one write(), and one frame more
    static constexpr std::uint64_t kEndless = std::numeric_limits<std::uint64_t>::max();

    /// `workload` must outlive this object. `hello` has no session and robot name yet.
    MeasuredClient(RobotPlan plan, const Workload& workload, wire::Hello hello);
    MeasuredClient(const MeasuredClient&) = delete;
    MeasuredClient& operator=(const MeasuredClient&) = delete;

    /// See ClientProtocol::open().
    void open(std::string server, Micros now, bool has_others = false) {
        protocol_.open(std::move(server), at(now), has_others);
    }
    void close(FleetFigures& figures) noexcept;

    [[nodiscard]] std::span<std::byte> prepare(std::size_t bytes) { return protocol_.prepare(bytes); }
    /// @return why the link has to end; if not retryable, why the robot gives up. Lost scans are counted in `figures`.
    [[nodiscard]] std::optional<wire::LinkError> on_bytes(std::size_t count, Micros now, FleetFigures& figures);

    /// The scans are due by the schedule, counted from `start`.
    void begin(Micros start) noexcept { start_ = start; }
    /// The robot has this many scans now; kEndless: always one more.
    void due(std::uint64_t scans, Micros now);
    /// No more scans follow: the total is what is due now, or what was sent if that is endless.
    void end() noexcept;

    /// Appends what may be sent now to `out`.
    void write(std::string& out, Micros now, FleetFigures& figures);

    /// Returns what is wrong with the link at `now`; call it about once a second.
    [[nodiscard]] std::optional<wire::LinkError> check(Micros now) const { return protocol_.check(at(now)); }

    [[nodiscard]] const RobotPlan& plan() const noexcept { return plan_; }
    [[nodiscard]] bool is_welcome() const noexcept { return protocol_.is_welcome(); }
    [[nodiscard]] bool is_done() const noexcept { return protocol_.is_done(); }
    [[nodiscard]] std::uint64_t acknowledged() const noexcept { return scans_.acknowledged(); }

private:
    struct Sending {
        std::uint64_t last_seq = 0;
        Micros at = 0;
    };

    static link::ClientProtocol::Time at(Micros time) {
        return link::ClientProtocol::Time(std::chrono::microseconds(time));
    }
    void record_sent(std::uint64_t first, std::uint64_t sent_ever_before, Micros now, FleetFigures& figures);
    void record_acknowledged(std::uint64_t first, Micros now, FleetFigures& figures);
    [[nodiscard]] Micros intended(std::uint64_t seq) const noexcept;

    RobotPlan plan_;
    const Workload* workload_;
    WorkloadQueue scans_;
    link::ClientProtocol protocol_;
    std::deque<Sending> sendings_; // on this link, not acknowledged yet
    Micros start_ = 0;
};

} // namespace scanloom::load
