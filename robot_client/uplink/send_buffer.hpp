#pragma once

#include "common/error/error.hpp"
#include "robot_client/source/source.hpp"

#include <cstddef>
#include <cstdint>
#include <deque>

namespace scanloom::robot {

/// Returns an upper bound, in bytes, for one scan within a batch on the wire.
[[nodiscard]] std::size_t wire_bytes_max(const Scan& scan) noexcept;

/// Scans of a robot that the server has not acknowledged, in order and numbered here: first those sent and not yet
/// durable, then those not yet sent. Bounded: while it has no room, its owner does not read the source.
///
///     acknowledged() < sent and waiting for an ack <= sent() < to be sent <= last()
class SendBuffer {
public:
    explicit SendBuffer(std::size_t bytes_max) : bytes_max_(bytes_max) {}

    /// Sets that the server has the scans up to `seq` from earlier runs; scans pushed already follow them. Pre: no scan
    /// was sent.
    void start_after(std::uint64_t seq) noexcept;

    [[nodiscard]] bool has_room() const noexcept { return bytes_ < bytes_max_; }
    [[nodiscard]] bool empty() const noexcept { return scans_.empty(); }

    /// Appends a scan and gives it the next seq. Pre: has_room().
    void push(Observation observation);

    /// Drops the oldest scan that was never sent; the scans after it move up.
    /// @return false if there is none
    bool drop_oldest_unsent() noexcept;

    /// Returns the number of scans not yet sent; unsent(0) is the next to send. Pre: index < unsent_count().
    [[nodiscard]] std::size_t unsent_count() const noexcept { return static_cast<std::size_t>(last_ - sent_); }
    [[nodiscard]] const Observation& unsent(std::size_t index) const noexcept;
    void mark_sent(std::size_t count) noexcept;

    /// Removes all scans up to `seq`, which are durable. Pre: seq <= sent().
    void acknowledge(std::uint64_t seq) noexcept;

    /// Prepares a new link on which the server has everything up to `seq`: the scans after it count as unsent.
    /// Errors: kConflict if the server lost scans that it had acknowledged, or has scans that were not sent from here.
    [[nodiscard]] Result<> rewind(std::uint64_t seq);

    [[nodiscard]] std::uint64_t acknowledged() const noexcept { return acknowledged_; }
    [[nodiscard]] std::uint64_t sent() const noexcept { return sent_; }
    /// Returns the highest seq sent on any link.
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
