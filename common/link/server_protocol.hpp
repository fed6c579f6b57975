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
    static constexpr int kCorrectionsPerSecond = 20; ///< the most that a robot receives

    /// Points in time, which the caller passes; the class reads no clock.
    using Time = std::chrono::steady_clock::time_point;
    /// Differences of points in time.
    using Duration = Time::duration;

    /// Authenticate the robot and let it join its session; then call on_joined() or on_not_joined().
    struct Join {
        wire::Hello hello; ///< session, robot, token and options of the robot
    };
    /// Pass a sensor's description to the session; then call on_durable().
    struct SubmitSensor {
        Sensor sensor;     ///< validated
        std::size_t bytes; ///< of credit, which on_durable() returns
    };
    /// Pass scans to the session; then call on_durable().
    struct SubmitScans {
        std::vector<Scan> scans; ///< validated, of one ScanBatch, by rising seq
        std::size_t bytes;       ///< of credit, which on_durable() returns
        Time read;               ///< when their last byte was read
    };
    /// Answer a request; then call on_reply() or on_request_refused().
    struct AnswerRequest {
        Request request; ///< with the id that the reply must have
    };
    /// Record in the audit log that the robot exceeded a limit of its token. The link ends.
    struct RecordLimit {};
    /// The link has ended: leave the session. The farewell follows.
    struct Leave {};
    /// Write the bytes, then call on_written().
    using Send = SendQueue::Piece;
    /// Shut down the sending side of the connection. All bytes were written before.
    struct ShutDownSending {};
    /// Close the connection. The last action.
    struct Close {};
    /// What the owner of the link does next.
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
        std::string session_id;               ///< Welcome.session_id
        std::uint64_t last_durable_seq = 0;   ///< of this robot; 0 if the session has no scan of it
        std::set<std::uint32_t> sensors = {}; ///< ids of the sensors that the robot has described
    };

    /// Starts the link of a connection that was accepted.
    /// @param config  deadlines and credit
    /// @param now     when the connection was accepted
    ServerProtocol(const ServerProtocolConfig& config, Time now);

    /// Sends the robot the reason why it is not served, instead of serving it. Call it before on_open().
    /// @param why  code and message that the robot receives
    /// @param now  the current time
    void turn_away(wire::LinkError why, Time now);

    // The connection
    /// Frames can be exchanged: the TLS handshake is done, or the connection has no TLS.
    void on_open();
    /// The TLS handshake failed. The link ends.
    void on_handshake_failed();
    /// Returns the space for the next read, valid until on_bytes(). Pre: reading() is not kNothing.
    [[nodiscard]] std::span<std::byte> prepare();
    /// Takes the first `count` bytes of the prepared space.
    /// @param count  at most the size of the space
    /// @param now    the current time, not before that of earlier calls
    /// @return how long the link is not read because of its rate limit
    Duration on_bytes(std::size_t count, Time now);
    /// The robot closed the connection, or it failed.
    void on_read_failed();
    /// The bytes of the last Send were written.
    void on_written() noexcept { is_writing_ = false; }
    /// The bytes of the last Send could not be written. Later bytes are discarded.
    void on_write_failed();
    /// A deadline may have passed. Call it at deadline(); an earlier call has no effect.
    void on_timer(Time now);

    // The session and the owner
    /// Applies the limits of the robot's token.
    /// @param limits  of the token that authenticated the robot
    /// @param now     the current time
    void set_limits(LinkLimits limits, Time now);
    /// The robot has joined its session. The welcome is sent.
    /// @param joined  what the welcome contains
    /// @param now     the current time
    void on_joined(Joined joined, Time now);
    /// The robot was not authenticated or could not join. The link ends with an error.
    /// @param why  code and message that the robot receives
    void on_not_joined(const Error& why);
    /// The scans up to `durable_seq` are durable and in the maps.
    /// @param durable_seq  highest Scan::seq of this robot that is durable; not less than in earlier calls
    /// @param bytes        credit returned, in addition to earlier calls
    void on_durable(std::uint64_t durable_seq, std::size_t bytes);
    /// The server has estimated where the robot is. The robot receives the newest correction only, at most
    /// kCorrectionsPerSecond, as soon as it has read the frames before; none before the welcome or after its goodbye.
    /// @param correction  replaces earlier ones that were not sent yet
    void on_located(const wire::Correction& correction) noexcept { correction_ = correction; }
    /// Queues the frame of a reply.
    /// @param frame  the encoded reply, including its length prefix
    /// @param kept   released when the frame is written
    void on_reply(std::string frame, std::shared_ptr<const void> kept);
    /// Queues the reply that refuses a request.
    /// @param request  as in AnswerRequest
    /// @param why      code and message of the reply
    void on_request_refused(const Request& request, const Error& why);
    /// Ends the link with an error. Only the first one counts.
    /// @param why  code and message that the robot receives
    void fail(const Error& why);

    /// States where the robot's session is, for a link that fails with kNotOwner.
    /// @param address  robot port of another server, HOST:PORT
    void set_owner(std::string address) { owner_ = std::move(address); }

    // What to do
    /// Returns the next action, or nullopt if there is none until the next event.
    [[nodiscard]] std::optional<Action> next_action(Time now);
    /// Returns what to read now.
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
    [[nodiscard]] bool can_send_correction() const noexcept;
    void begin_farewell(Time now);
    void queue_last_message();

    const ServerProtocolConfig config_;
    State state_ = State::kConnecting;
    wire::FrameDecoder decoder_{wire::kFrameBytesMaxBeforeHello};
    bool may_hold_frame_ = false; // whether the decoder may have a frame
    SendQueue queue_;
    LimitCheck limits_;
    Time deadline_;
    std::optional<Time> resumes_;                // when the link is read again
    std::optional<wire::Correction> correction_; // the newest, until it is queued
    Time correction_due_ = Time::min();          // when it may be queued
    Time read_;                                  // when bytes were last read

    std::size_t under_way_ = 0; // bytes submitted and not yet durable
    std::size_t described_ = 0; // upper bound of the bytes of sensor descriptions in under_way_; at most under_way_
    std::size_t asked_ = 0;     // requests that are not answered yet

    std::optional<Error> ended_by_;
    std::string owner_;                          // of the session, if another server has it
    std::optional<wire::LinkError> turned_away_; // the reason, until it is queued
    bool is_welcome_ = false;                    // a welcome was sent
    bool is_over_limit_ = false;                 // RecordLimit is due
    bool leaves_ = false;                        // Leave is due
    bool is_writing_ = false;
    bool is_closed_ = false; // Close was returned
};

/// Returns whether the same hello may succeed after this error.
/// @param code  of the error that ended the link
[[nodiscard]] bool is_retryable(Errc code) noexcept;

} // namespace scanloom::link
