#pragma once

#include "common/error/error.hpp"
#include "common/link/link_limits.hpp"
#include "common/link/requests.hpp"
#include "common/link/send_queue.hpp"
#include "common/wire/frame_decoder.hpp"
#include "common/wire/messages.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace scanloom::link {

/// Settings of a ServerProtocol.
struct ServerProtocolConfig {
    std::chrono::steady_clock::duration hello_deadline = std::chrono::seconds(5);    ///< from accepting to the hello
    std::chrono::steady_clock::duration idle_deadline = std::chrono::seconds(60);    ///< an idle robot sends pings
    std::chrono::steady_clock::duration farewell_deadline = std::chrono::seconds(2); ///< for the robot to hang up
    std::size_t credit_bytes = std::size_t{2} << 20; ///< of ScanBatch frames not durable yet; more than one frame
};

/// The server's side of one robot link as a state machine without sockets, threads and clocks, from the connection to
/// its end. link::ClientProtocol is the other side.
///
/// After the hello, the owner authenticates the robot and lets it join its session, and the robot receives a welcome.
/// Then sensor descriptions and scans go to the session, which returns acks, and requests to the owner, which returns
/// replies. The link ends with a goodbye, after which pending scans are still acknowledged; with an error, which is
/// sent to the robot; or with the end of the connection.
///
/// Usage: after construction and after each event, perform the actions of next_action() until it returns nullopt. Then
/// start the read that reading() asks for, unless one is running, and call on_timer() at deadline().
/// Threads: one at a time.
/// Source: proto/scanloom/v1/frame.proto.
class ServerProtocol {
public:
    using Time = std::chrono::steady_clock::time_point;
    using Duration = Time::duration;

    /// Authenticate the robot and let it join its session; then call on_joined() or on_not_joined().
    struct Join {
        wire::Hello hello;
    };
    struct SubmitSensor {
        Sensor sensor;
        std::size_t bytes; ///< of credit, which on_durable() returns
    };
    struct SubmitScans {
        std::vector<Scan> scans;
        std::size_t bytes; ///< of credit, which on_durable() returns
        Time read;         ///< when their last byte was read
    };
    /// Answer a request; then call on_reply() or on_request_refused().
    struct AnswerRequest {
        Request request;
    };
    /// Record in the audit log that the robot exceeded a limit of its token. The link ends.
    struct RecordLimit {};
    /// The link has ended: leave the session. The farewell follows.
    struct Leave {};
    /// Write the bytes, then call on_written().
    using Send = SendQueue::Piece;
    struct ShutDownSending {};
    /// Close the connection. The last action.
    struct Close {};
    using Action =
        std::variant<Join, SubmitSensor, SubmitScans, AnswerRequest, RecordLimit, Leave, Send, ShutDownSending, Close>;

    /// What to read from the connection.
    enum class Reading {
        kNothing,
        kFrames,   ///< through TLS, if the connection has it
        kUntilEnd, ///< bytes to discard, not decrypted, until the robot closes the connection
    };

    /// The result of joining a session.
    struct Joined {
        std::string session_id; ///< Welcome.session_id
        std::uint64_t last_durable_seq = 0;
        std::set<std::uint32_t> sensors = {}; ///< ids of the sensors that the robot has described
    };

    ServerProtocol(const ServerProtocolConfig& config, Time now);

    /// Sends the robot the reason why it is not served, instead of serving it. Call it before on_open().
    void turn_away(wire::LinkError why, Time now);

    // The connection
    /// Frames can be exchanged: the TLS handshake is done, or the connection has no TLS.
    void on_open();
    void on_handshake_failed();
    /// Returns the space for the next read, valid until on_bytes(). Pre: reading() is not kNothing.
    [[nodiscard]] std::span<std::byte> prepare();
    /// Takes the first `count` bytes of the prepared space.
    /// @return how long the link is not read because of its rate limit
    Duration on_bytes(std::size_t count, Time now);
    /// The robot closed the connection, or it failed.
    void on_read_failed();
    void on_written() noexcept { is_writing_ = false; }
    void on_write_failed();
    void on_timer(Time now);

    // The session and the owner
    /// Applies the limits of the robot's token.
    void set_limits(LinkLimits limits, Time now);
    void on_joined(Joined joined, Time now);
    void on_not_joined(const Error& why);
    /// The scans up to `durable_seq` are durable and in the maps.
    /// @param bytes  credit returned, in addition to earlier calls
    void on_durable(std::uint64_t durable_seq, std::size_t bytes);
    /// Queues the frame of a reply.
    /// @param kept  released when the frame is written
    void on_reply(std::string frame, std::shared_ptr<const void> kept);
    void on_request_refused(const Request& request, const Error& why);
    /// Ends the link with an error. Only the first one counts.
    void fail(const Error& why);

    // What to do
    [[nodiscard]] std::optional<Action> next_action(Time now);
    [[nodiscard]] Reading reading() const noexcept;
    /// Returns when to call on_timer(); Time::max(): never.
    [[nodiscard]] Time deadline() const noexcept;

    /// Returns why the link has ended; nullopt after a goodbye, and before the end.
    [[nodiscard]] const std::optional<Error>& ended_by() const noexcept { return ended_by_; }

private:
    enum class State {
        kConnecting, ///< TLS handshake
        kHello,      ///< before the hello
        kJoining,
        kJoined,
        kSettling,  ///< after the goodbye, until all is durable and answered
        kFarewell,  ///< the rest of the queue is written
        kHangingUp, ///< until the robot closes the connection
        kClosed,
    };

    [[nodiscard]] std::optional<Action> next_of_frames(Time now);
    [[nodiscard]] std::optional<Action> next_of_farewell(Time now);
    [[nodiscard]] Result<std::optional<Action>> take_frame(std::string_view body, Time now);
    [[nodiscard]] Result<std::optional<Action>> take_hello(wire::Message message);
    [[nodiscard]] Result<std::optional<Action>> take_message(wire::Message message, std::size_t frame_bytes);
    [[nodiscard]] Result<std::optional<Action>> take_request(Request request);
    [[nodiscard]] bool is_paused() const noexcept { return resumes_.has_value(); }
    [[nodiscard]] Result<> check_small_answers() const;
    [[nodiscard]] Result<> charge_batch(std::size_t bytes);
    [[nodiscard]] Result<> charge_description(std::size_t bytes);
    void begin_farewell(Time now);
    void queue_last_message();

    const ServerProtocolConfig config_;
    State state_ = State::kConnecting;
    wire::FrameDecoder decoder_{wire::kFrameBytesMaxBeforeHello};
    bool may_hold_frame_ = false; // whether the decoder may have a frame
    SendQueue queue_;
    LimitCheck limits_;
    Time deadline_;
    std::optional<Time> resumes_; // when the link is read again
    Time read_;                   // when bytes were last read

    std::size_t under_way_ = 0; // bytes submitted and not yet durable
    std::size_t described_ = 0; // upper bound of the bytes of sensor descriptions in under_way_; at most under_way_
    std::size_t asked_ = 0;     // requests that are not answered yet

    std::optional<Error> ended_by_;
    std::optional<wire::LinkError> turned_away_; // the reason, until it is queued
    bool is_welcome_ = false;                    // a welcome was sent
    bool is_over_limit_ = false;                 // RecordLimit is due
    bool leaves_ = false;                        // Leave is due
    bool is_writing_ = false;
    bool is_closed_ = false; // Close was returned
};

/// Returns whether the same hello may succeed after this error.
[[nodiscard]] bool is_retryable(Errc code) noexcept;

} // namespace scanloom::link
