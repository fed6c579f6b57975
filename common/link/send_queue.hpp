#pragma once

#include "common/wire/messages.hpp"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace scanloom::link {

/// Queues the frames that a server has to write to a robot, in order. Of several acks only the newest is kept. Replies
/// to requests, which may be long, follow one at a time when no other frame waits.
///
/// Queue: "link's send queue": pongs and refusals, which the caller bounds by waiting(); replies, by replies_waiting();
///        and one ack.
/// Threads: one at a time.
class SendQueue {
public:
    /// The bytes of one write.
    struct Piece {
        std::string bytes;                          ///< not empty
        std::shared_ptr<const void> kept{};         ///< released when the bytes are written
        std::optional<std::uint64_t> durable_seq{}; ///< of the newest ack in it
    };

    /// Appends a message, after the ack that waits, if any.
    /// @param message  any message of a server but an ack or a reply to a request
    void add(const wire::Message& message);

    /// Appends bytes that are not a frame.
    /// @param bytes  written as they are, after the messages added before
    void add_bytes(std::string_view bytes);

    /// Queues an ack. It replaces an earlier one that still waits.
    /// @param ack  its durable_seq is not less than that of earlier acks
    void acknowledge(const wire::Ack& ack);

    /// Queues the frame of a reply, which is written when no other frame waits.
    /// @param frame  the encoded reply, including its length prefix
    /// @param kept   released when the frame is written
    void add_reply(std::string frame, std::shared_ptr<const void> kept);

    /// Ignores all further additions.
    void close() noexcept { closed_ = true; }

    /// Takes the next piece to write, or nullopt if the queue is empty.
    [[nodiscard]] std::optional<Piece> next();

    /// Returns the number of replies that were not taken yet. The reply being written does not count: the robot may
    /// have read all of it, and sent its next request, before the write completes here.
    [[nodiscard]] std::size_t replies_waiting() const noexcept { return replies_.size(); }

    /// Returns how many bytes, without replies and the ack that waits, were not taken yet.
    [[nodiscard]] std::size_t waiting() const noexcept { return bytes_.size(); }

private:
    void append_ack();

    std::string bytes_;
    std::deque<Piece> replies_;
    std::optional<wire::Ack> ack_;             // the newest, not in bytes_ yet
    std::optional<std::uint64_t> durable_seq_; // of the newest ack in bytes_
    bool closed_ = false;
};

} // namespace scanloom::link
