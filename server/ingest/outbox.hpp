#pragma once

#include "common/wire/messages.hpp"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace scanloom::ingest {

/// Queues the frames that a link has to write to its robot, in order. Of several acks only the newest is kept. Replies
/// to requests, which may be long, follow one at a time when nothing else waits.
///
/// Queue: "link's outbox": pongs and refusals, which the caller bounds by waiting(); replies, by answers_waiting(); and
///        one ack.
/// Threads: one at a time.
class Outbox {
public:
    /// The bytes of one write.
    struct Piece {
        std::string bytes;
        std::shared_ptr<const void> kept{};         ///< released when the bytes are written
        std::optional<std::uint64_t> durable_seq{}; ///< of the newest ack in it
    };

    /// @param added  called after every addition, also while the outbox is not empty
    explicit Outbox(std::function<void()> added) : added_(std::move(added)) {}

    /// Appends a message, after the ack that waits, if any.
    void send(const wire::Message& message);

    /// Appends bytes that are not a frame.
    void send_bytes(std::string_view bytes);

    /// Queues an ack. It replaces an earlier one that still waits.
    void acknowledge(const wire::Ack& ack);

    /// Queues the frame of a reply, which is written when nothing else waits.
    /// @param kept  released when the frame is written
    void answer(std::string frame, std::shared_ptr<const void> kept);

    /// Ignores all further additions.
    void close() { closed_ = true; }

    /// Takes the next piece to write, or nullopt if the outbox is empty.
    [[nodiscard]] std::optional<Piece> next();

    /// Returns the number of replies that were not taken yet. The reply being written does not count: the robot may
    /// have read all of it, and sent its next request, before the write completes here.
    [[nodiscard]] std::size_t answers_waiting() const noexcept { return answers_.size(); }

    /// Returns how many bytes, without replies and the ack that waits, were not taken yet.
    [[nodiscard]] std::size_t waiting() const noexcept { return bytes_.size(); }

private:
    void put_ack();

    std::function<void()> added_;
    std::string bytes_;
    std::deque<Piece> answers_;
    std::optional<wire::Ack> ack_;             // the newest, not in bytes_ yet
    std::optional<std::uint64_t> durable_seq_; // of the newest ack in bytes_
    bool closed_ = false;
};

} // namespace scanloom::ingest
