#pragma once

#include "common/error/error.hpp"
#include "load/core/micros.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <random>
#include <string_view>

namespace scanloom::load {

/// A fault of a robot's link.
enum class Fault : std::uint8_t {
    kCut,      ///< the link is reset, whatever is in progress
    kHalfOpen, ///< the robot reconnects and leaves the old connection open, as after a change of its address
    kStall,    ///< nothing is read or written for kStallTime, as in a radio gap
};
inline constexpr std::size_t kFaultKinds = 3;
inline constexpr std::array<std::string_view, kFaultKinds> kFaultNames{"cut", "half-open", "stall"};
inline constexpr Micros kStallTime = 2 * kSecond;

/// Mean seconds between two faults of a kind on the same link; 0: none.
using FaultMeans = std::array<double, kFaultKinds>;

/// Parses "cut=20,half-open=60,stall=30".
/// Errors: kInvalidField: the message names the invalid part.
[[nodiscard]] Result<FaultMeans> parse_faults(std::string_view text);

/// Which robot's link fails when and how: a Poisson process, so faults are independent of each other; equal seeds give
/// equal faults.
class FaultSchedule {
public:
    /// Pre: robots > 0.
    FaultSchedule(const FaultMeans& means, std::uint32_t robots, std::uint64_t seed);

    [[nodiscard]] bool is_empty() const noexcept { return per_second_ <= 0.0; }

    struct Event {
        Micros after = 0; ///< since the previous event
        std::uint32_t robot = 0;
        Fault fault = Fault::kCut;
    };
    /// Pre: !is_empty().
    [[nodiscard]] Event next();

private:
    [[nodiscard]] double uniform(); // [0, 1)

    std::array<double, kFaultKinds> rates_{}; // per second, of all robots
    double per_second_ = 0.0;
    std::uint32_t robots_;
    std::mt19937_64 random_;
};

} // namespace scanloom::load
