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

/// The server's side of the robot link once the robot has joined its session, without a socket and without a clock:
/// which scans are under way, what may still come, what is answered. robot::Conversation is the other side.
///
/// Usage   welcome(); then handle() for every frame; on_durable() as the session tells. What is to be written is in the
///         Outbox.
/// Errors  an error of handle() ends the link.
/// Thread  one at a time.
/// Source  proto/scanloom/v1/frame.proto.
class Dialogue {
public:
    using Time = Unacknowledged::Time;

    /// `credit_bytes` of scan batches may be under way. All but it must outlive this.
    Dialogue(metrics::IngestCounters& counters, Outbox& outbox, std::size_t credit_bytes)
        : counters_(counters), outbox_(outbox), credit_bytes_(credit_bytes), unacknowledged_(counters) {}

    /// The session has let the robot in.
    void welcome(std::shared_ptr<session::Session> session, const session::Joined& joined);
    [[nodiscard]] bool is_welcome() const noexcept { return session_ != nullptr; }
    [[nodiscard]] const std::shared_ptr<session::Session>& session() const noexcept { return session_; }
    [[nodiscard]] RobotIndex robot() const noexcept { return robot_; }

    /// A message of `frame_bytes`, length prefix included, the last of which were read at `read`. `self` is the link
    /// that joined.
    /// Pre  is_welcome(); the message is neither compressed nor a request.
    [[nodiscard]] Result<> handle(wire::Message message, std::size_t frame_bytes, Time read,
                                  std::shared_ptr<session::RobotListener> self);

    /// RobotListener::on_durable().
    void on_durable(std::uint64_t durable_seq, std::size_t bytes);

    /// An ack was handed to the socket.
    void acknowledged(std::uint64_t durable_seq, Time now) { unacknowledged_.acknowledge(durable_seq, now); }

    /// Whether one more small answer may wait to be read.
    [[nodiscard]] Result<> check_small_answers() const;

    [[nodiscard]] bool said_goodbye() const noexcept { return goodbye_; }
    /// Whether something submitted is not durable yet.
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
    std::size_t described_ = 0; // at least as many of them as are of sensor descriptions, never more than all
    bool goodbye_ = false;
    Unacknowledged unacknowledged_;
};

} // namespace scanloom::ingest
