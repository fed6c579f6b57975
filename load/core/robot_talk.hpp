#pragma once

#include "common/link/credit_window.hpp"
#include "common/wire/messages.hpp"
#include "load/core/course.hpp"
#include "load/core/fleet_figures.hpp"
#include "load/core/micros.hpp"

#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace scanloom::load {

/// One robot of many.
struct RobotPlan {
    std::uint32_t index = 0; ///< among all robots
    std::string session;
    std::string name;           ///< within the session
    std::size_t first_scan = 0; ///< where on the course it starts
};

/// The robot's side of the robot link, for one of thousands of robots: without a socket, without a clock, and without
/// keeping the scans in flight, because each can be generated again from its number.
///
/// Usage: link up: open(); for every received frame: receive(); after each event write(), and send its output; link
/// down: close(). As time passes: due(). After the last scan: end().
/// Threads: one at a time.
/// Source: proto/scanloom/v1/frame.proto. Unlike link::ClientProtocol, which serves a single robot, it has no sources,
///         requests, compression or buffers.
class RobotTalk {
public:
    static constexpr std::size_t kWriteMax = std::size_t{64} << 10; ///< bytes of one write(), or one frame
    static constexpr Micros kWelcomeMax = 60 * kSecond; ///< since the hello: the server creates sessions one by one
    static constexpr Micros kPingAfter = 5 * kSecond;   ///< without sending anything
    static constexpr Micros kSilenceMax = 15 * kSecond; ///< while the server owes an answer
    static constexpr std::uint64_t kEndless = std::numeric_limits<std::uint64_t>::max();

    /// `course` and `hello` must outlive this object. `hello` has no session and robot name yet.
    RobotTalk(RobotPlan plan, const Course& course, const wire::Hello& hello);

    void open(Micros now);
    void close(FleetFigures& figures) noexcept;

    /// @return why the link has to end; if not retryable, why the robot gives up. Lost scans are counted in `figures`.
    [[nodiscard]] std::optional<wire::LinkError> receive(const wire::Message& message, Micros now,
                                                         FleetFigures& figures);

    /// The scans are due by the schedule, counted from `start`.
    void begin(Micros start) noexcept { start_ = start; }
    /// The robot has this many scans now; kEndless: always one more.
    void due(std::uint64_t scans) noexcept { due_ = scans; }
    /// No more scans follow: the total is what is due now, or what was sent if that is endless.
    void end() noexcept;

    /// Appends what may be sent now to `out`: at most kWriteMax bytes, or one frame.
    void write(std::string& out, Micros now, FleetFigures& figures);

    /// Returns what is wrong with the link at `now`; call it about once a second.
    [[nodiscard]] std::optional<wire::LinkError> check(Micros now) const;

    [[nodiscard]] const RobotPlan& plan() const noexcept { return plan_; }
    [[nodiscard]] bool is_welcome() const noexcept { return link_.welcomed; }
    [[nodiscard]] bool was_ever_welcome() const noexcept { return !session_id_.empty(); }
    [[nodiscard]] bool is_done() const noexcept { return ended_ && durable_ == due_; }
    [[nodiscard]] std::uint64_t acknowledged() const noexcept { return durable_; }
    [[nodiscard]] std::uint64_t sent() const noexcept { return sent_ever_; }

private:
    struct Link {
        bool is_open = false;
        bool said_hello = false;
        bool welcomed = false;
        bool described = false;
        bool said_goodbye = false;
        bool pinged = false; // and nothing was received since
        Micros opened = 0;
        Micros said = 0;
        Micros waits_since = 0;                 // for what the server owes, with nothing received since
        std::optional<std::uint64_t> to_answer; // nonce of the newest ping
    };
    struct Sending {
        std::uint64_t last_seq = 0;
        Micros at = 0;
    };

    [[nodiscard]] std::optional<wire::LinkError> on_welcome(const wire::Welcome& welcome, Micros now,
                                                            FleetFigures& figures);
    [[nodiscard]] std::optional<wire::LinkError> on_ack(const wire::Ack& ack, Micros now, FleetFigures& figures);
    void acknowledge(std::uint64_t seq, Micros now, FleetFigures& figures);
    void write_small_frames(std::string& out, Micros now);
    void write_scans(std::string& out, Micros now, FleetFigures& figures);
    [[nodiscard]] std::uint64_t next_batch() const noexcept;
    [[nodiscard]] bool is_owed_something() const noexcept;
    [[nodiscard]] Micros intended(std::uint64_t seq) const noexcept;
    void note_sent(std::uint64_t count, Micros now, FleetFigures& figures);

    RobotPlan plan_;
    const Course* course_;
    const wire::Hello* hello_;
    Link link_;
    link::CreditWindow credit_;
    std::deque<Sending> sendings_; // on this link, not acknowledged yet
    std::vector<wire::NumberedScan> batch_;
    std::string session_id_;
    Micros start_ = 0;
    std::uint64_t due_ = 0;
    std::uint64_t sent_ = 0; // on this link
    std::uint64_t sent_ever_ = 0;
    std::uint64_t durable_ = 0;
    bool ended_ = false;
};

} // namespace scanloom::load
