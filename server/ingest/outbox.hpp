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

/// What a link still has to write to its robot, in order; of acks only the newest. Answers to requests, which may be
/// long, come one by one when nothing else waits.
///
/// Queue   "link's outbox": pongs and refusals, which whoever reads bounds by waiting(); answers, by
///         answers_waiting(); and one ack.
/// Thread  one at a time.
class Outbox {
public:
    /// What is written at once.
    struct Piece {
        std::string bytes;
        std::shared_ptr<const void> kept{};         ///< until it is written
        std::optional<std::uint64_t> durable_seq{}; ///< of the newest ack in it
    };

    /// `added` is called whenever there is something to write, perhaps in addition to more.
    explicit Outbox(std::function<void()> added) : added_(std::move(added)) {}

    void send(const wire::Message& message);
    void send_bytes(std::string_view bytes);

    /// Replaces an ack that was not taken yet.
    void acknowledge(const wire::Ack& ack);

    /// Sends a whole frame after all else. `kept` is let go of when it was written.
    void answer(std::string frame, std::shared_ptr<const void> kept);

    /// Nothing may follow what is in it.
    void close() { closed_ = true; }

    /// Takes what is next. Acks that come until then collapse into the newest. Nothing: all was taken.
    [[nodiscard]] std::optional<Piece> next();

    /// Answers that were not taken yet. The one being written is not among them: the robot may have read the whole of
    /// it, and ask the next, before this side hears that it was written.
    [[nodiscard]] std::size_t answers_waiting() const noexcept { return answers_.size(); }

    /// Bytes that were not taken yet.
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
