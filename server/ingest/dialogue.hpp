#pragma once

#include "common/error/error.hpp"
#include "common/wire/messages.hpp"
#include "server/ingest/outbox.hpp"
#include "server/ingest/unacknowledged.hpp"
#include "server/metrics/metrics.hpp"
#include "server/session/robot_listener.hpp"
#include "server/session/session.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>

namespace scanloom::ingest {

/// The server's side of the robot link after the robot has joined its session, without a socket and without a clock. It
/// decides which messages are accepted and what is answered, and counts the bytes that are not durable yet.
/// robot::Conversation is the other side.
///
/// Call welcome(), then handle() for every frame, and on_durable() when the session reports progress. Frames to be
/// written are put into the Outbox. An error of handle() ends the link.
/// Threads: one at a time.
/// Source: proto/scanloom/v1/frame.proto.
class Dialogue {
public:
    using Time = Unacknowledged::Time;

    /// @param counters      outlives this object
    /// @param outbox        outlives this object
    /// @param credit_bytes  of scan batches that may be submitted and not durable yet
    Dialogue(metrics::IngestCounters& counters, Outbox& outbox, std::size_t credit_bytes)
        : counters_(counters), outbox_(outbox), credit_bytes_(credit_bytes), unacknowledged_(counters) {}

    /// Sends the welcome, after the robot has joined `session`.
    void welcome(std::shared_ptr<session::Session> session, const session::Joined& joined);
    [[nodiscard]] bool is_welcome() const noexcept { return session_ != nullptr; }
    [[nodiscard]] const std::shared_ptr<session::Session>& session() const noexcept { return session_; }
    [[nodiscard]] RobotIndex robot() const noexcept { return robot_; }

    /// Handles the next message of the robot.
    /// @param frame_bytes  size of the message's frame, including the length prefix
    /// @param read         when the last byte of the frame was read
    /// @param self         the link that joined the session
    /// Pre: is_welcome(); the message is neither compressed nor a request.
    /// Errors: kCreditExceeded if too many bytes are not durable yet, or too many pongs and refusals have not been
    ///         read; kMalformed if the message is not one that the server takes.
    [[nodiscard]] Result<> handle(wire::Message message, std::size_t frame_bytes, Time read,
                                  std::shared_ptr<session::RobotListener> self);

    /// Handles RobotListener::on_durable(): acknowledges the scans and returns their credit.
    void on_durable(std::uint64_t durable_seq, std::size_t bytes);

    /// Records that an ack was passed to the socket.
    void acknowledged(std::uint64_t durable_seq, Time now) { unacknowledged_.acknowledge(durable_seq, now); }

    /// Checks whether one more pong or refusal may be queued.
    /// Errors: kCreditExceeded if too many bytes of them have not been read.
    [[nodiscard]] Result<> check_small_answers() const;

    [[nodiscard]] bool said_goodbye() const noexcept { return goodbye_; }
    /// Returns whether something submitted is not durable yet.
    [[nodiscard]] bool has_under_way() const noexcept { return under_way_ > 0; }

private:
    [[nodiscard]] Result<> charge_batch(std::size_t bytes);
    [[nodiscard]] Result<> charge_description(std::size_t bytes);

    metrics::IngestCounters& counters_;
    Outbox& outbox_;
    const std::size_t credit_bytes_;
    std::shared_ptr<session::Session> session_;
    RobotIndex robot_ = 0;      // in the session
    std::size_t under_way_ = 0; // bytes submitted and not yet durable
    std::size_t described_ = 0; // upper bound of the bytes of sensor descriptions in under_way_; at most under_way_
    bool goodbye_ = false;
    Unacknowledged unacknowledged_;
};

} // namespace scanloom::ingest
