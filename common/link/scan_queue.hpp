#pragma once

#include "common/error/error.hpp"
#include "common/scan/sensor.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

namespace scanloom::link {

/// The scans that a ClientProtocol sends, numbered in order from 1: first those that are durable, then those sent and
/// not yet durable, then those not yet sent. A derived class keeps the scans, or generates them again when needed.
///
///     acknowledged() <= sent() <= last(),  sent() <= sent_ever()
/// Threads: one at a time.
class ScanQueue {
public:
    virtual ~ScanQueue() = default;

    /// Returns the highest number of a scan that can be sent now.
    [[nodiscard]] virtual std::uint64_t last() const noexcept = 0;
    /// Returns the sensor of an unsent scan. Pre, also below: acknowledged() < seq <= last().
    /// @param seq  number of the scan
    [[nodiscard]] virtual const std::shared_ptr<const Sensor>& sensor(std::uint64_t seq) const = 0;
    /// Returns the number of beams of a scan.
    /// @param seq  number of the scan
    [[nodiscard]] virtual std::size_t beams(std::uint64_t seq) const = 0;
    /// Returns an upper bound, in bytes, for one scan within a batch on the wire.
    /// @param seq  number of the scan
    [[nodiscard]] virtual std::size_t bytes_max(std::uint64_t seq) const = 0;
    /// Appends a ScanBatch frame of `count` scans from `first` on to `out`.
    /// @param first  number of the first scan; all of them can be sent
    /// @param count  at least 1
    /// @param out    receives the frame, including its length prefix; what it holds is kept
    virtual void append_batch(std::uint64_t first, std::size_t count, std::string& out) const = 0;

    /// Sets that the server has the scans up to `seq` from earlier runs; queued scans follow them. Pre: no scan was
    /// sent.
    /// @param seq  highest number that the server has, 0 if none
    void start_after(std::uint64_t seq);
    /// Counts the next unsent scans as sent. Pre: count <= unsent_count().
    void mark_sent(std::size_t count) noexcept;
    /// Removes all scans up to `seq`, which are durable. Pre: seq <= sent().
    /// @param seq  numbers up to acknowledged() are ignored
    void acknowledge(std::uint64_t seq);
    /// Prepares a new link on which the server has everything up to `seq`: the scans after it count as unsent.
    /// @param seq  highest number that the server has, 0 if none
    /// Errors: kConflict if the server lost scans that it had acknowledged, or has scans that were not sent from here.
    [[nodiscard]] Result<> rewind(std::uint64_t seq);

    /// Returns the number of scans that can be sent now.
    [[nodiscard]] std::uint64_t unsent_count() const noexcept { return last() > sent_ ? last() - sent_ : 0; }
    /// Returns whether all queued scans are durable.
    [[nodiscard]] bool all_acknowledged() const noexcept { return acknowledged_ == last(); }
    /// Returns the highest durable seq, 0 if there is none.
    [[nodiscard]] std::uint64_t acknowledged() const noexcept { return acknowledged_; }
    /// Returns the highest seq sent on the current link, or durable.
    [[nodiscard]] std::uint64_t sent() const noexcept { return sent_; }
    /// Returns the highest seq sent on any link.
    [[nodiscard]] std::uint64_t sent_ever() const noexcept { return sent_ever_; }

protected:
    /// Numbers the queued scans from `first` on.
    virtual void renumber(std::uint64_t first) = 0;
    /// Drops the scans acknowledged() + 1 to `seq`.
    virtual void drop_until(std::uint64_t seq) = 0;

private:
    std::uint64_t acknowledged_ = 0;
    std::uint64_t sent_ = 0;
    std::uint64_t sent_ever_ = 0;
};

} // namespace scanloom::link
