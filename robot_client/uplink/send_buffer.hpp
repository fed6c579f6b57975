#pragma once

#include "common/link/scan_queue.hpp"
#include "robot_client/sources/source.hpp"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>

namespace scanloom::robot {

/// Returns an upper bound, in bytes, for one scan within a batch on the wire.
[[nodiscard]] std::size_t wire_bytes_max(const Scan& scan) noexcept;

/// The scans of a robot that the server has not acknowledged, in memory, numbered here. Bounded: while it has no room,
/// its owner does not read the source.
class SendBuffer final : public link::ScanQueue {
public:
    explicit SendBuffer(std::size_t bytes_max) : bytes_max_(bytes_max) {}

    [[nodiscard]] bool has_room() const noexcept { return bytes_ < bytes_max_; }

    /// Appends a scan and gives it the next seq. Pre: has_room().
    void push(Observation observation);

    /// Drops the oldest scan that was never sent; the scans after it move up.
    /// @return false if there is none
    bool drop_oldest_unsent() noexcept;

    [[nodiscard]] std::uint64_t last() const noexcept override { return last_; }
    [[nodiscard]] const std::shared_ptr<const Sensor>& sensor(std::uint64_t seq) const override {
        return at(seq).sensor;
    }
    [[nodiscard]] std::size_t beams(std::uint64_t seq) const override { return at(seq).scan.ranges.size(); }
    [[nodiscard]] std::size_t bytes_max(std::uint64_t seq) const override { return wire_bytes_max(at(seq).scan); }
    void append_batch(std::uint64_t first, std::size_t count, std::string& out) const override;

private:
    void renumber(std::uint64_t first) override;
    void drop_until(std::uint64_t seq) override;
    [[nodiscard]] const Observation& at(std::uint64_t seq) const;

    std::size_t bytes_max_;
    std::size_t bytes_ = 0;
    std::deque<Observation> scans_; // acknowledged() + 1 .. last_
    std::uint64_t last_ = 0;
};

} // namespace scanloom::robot
