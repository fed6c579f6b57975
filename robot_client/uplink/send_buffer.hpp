#pragma once

#include "common/error/error.hpp"
#include "robot_client/source/source.hpp"

#include <cstddef>
#include <cstdint>
#include <deque>

namespace scanloom::robot {

/// At most this many bytes on the wire, for one scan within a batch.
[[nodiscard]] std::size_t wire_bytes_max(const Scan& scan) noexcept;

/// The scans of a robot that the server has not acknowledged, in order, numbered here: those sent and not yet durable,
/// then those not yet sent. Bounded: when it has no room, its owner stops asking the source.
///
///     acknowledged() < sent and waiting for an ack <= sent() < to be sent <= last()
class SendBuffer {
public:
    explicit SendBuffer(std::size_t bytes_max) : bytes_max_(bytes_max) {}

    /// The server holds the scans up to `seq` from earlier runs; those pushed already follow. Pre: nothing was sent.
    void start_after(std::uint64_t seq) noexcept;

    [[nodiscard]] bool has_room() const noexcept { return bytes_ < bytes_max_; }
    [[nodiscard]] bool empty() const noexcept { return scans_.empty(); }

    /// Appends a scan and gives it the next seq. Pre: has_room().
    void push(Observation observation);

    /// Drops the oldest scan that was never sent, and those behind it move up. @return false where there is none.
    bool drop_oldest_unsent() noexcept;

    /// The scans not yet sent: unsent(0) is the next to go. Pre: index < unsent_count().
    [[nodiscard]] std::size_t unsent_count() const noexcept { return static_cast<std::size_t>(last_ - sent_); }
    [[nodiscard]] const Observation& unsent(std::size_t index) const noexcept;
    void mark_sent(std::size_t count) noexcept;

    /// Everything up to `seq` is durable. Pre: seq <= sent().
    void acknowledge(std::uint64_t seq) noexcept;

    /// A new link on which the server holds everything up to `seq`: what follows counts as unsent.
    /// Errors  kConflict: the server lost scans it had acknowledged, or has scans that never came from here.
    [[nodiscard]] Result<> rewind(std::uint64_t seq);

    [[nodiscard]] std::uint64_t acknowledged() const noexcept { return acknowledged_; }
    [[nodiscard]] std::uint64_t sent() const noexcept { return sent_; }
    /// The highest seq that went out on any link.
    [[nodiscard]] std::uint64_t sent_ever() const noexcept { return sent_ever_; }
    [[nodiscard]] std::uint64_t last() const noexcept { return last_; }

private:
    std::size_t bytes_max_;
    std::size_t bytes_ = 0;
    std::deque<Observation> scans_; // acknowledged_ + 1 .. last_
    std::uint64_t acknowledged_ = 0;
    std::uint64_t sent_ = 0;
    std::uint64_t sent_ever_ = 0;
    std::uint64_t last_ = 0;
};

} // namespace scanloom::robot
