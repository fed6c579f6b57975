#pragma once

#include "common/error/error.hpp"
#include "load/core/micros.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <random>
#include <string_view>

namespace scanloom::load {

/// What happens to a robot's link.
enum class Fault : std::uint8_t {
    kCut,      ///< it is reset, whatever was under way
    kHalfOpen, ///< the robot connects anew and leaves the old connection standing, as where its address changes
    kStall,    ///< nothing is read from it nor written to it for kStallTime: a gap in the radio
};
inline constexpr std::size_t kFaultKinds = 3;
inline constexpr std::array<std::string_view, kFaultKinds> kFaultNames{"cut", "half-open", "stall"};
inline constexpr Micros kStallTime = 2 * kSecond;

/// Seconds from one fault of a kind to the next on the same link, on average; 0: none.
using FaultMeans = std::array<double, kFaultKinds>;

/// "cut=20,half-open=60,stall=30".
/// Errors  kInvalidField: what is wrong with it.
[[nodiscard]] Result<FaultMeans> parse_faults(std::string_view text);

/// When which robot's link fails and how: at random moments that know nothing of each other (a Poisson process), the
/// same for the same seed.
class FaultSchedule {
public:
    /// Pre  robots > 0
    FaultSchedule(const FaultMeans& means, std::uint32_t robots, std::uint64_t seed);

    [[nodiscard]] bool is_empty() const noexcept { return per_second_ <= 0.0; }

    struct Event {
        Micros after = 0; ///< since the event before
        std::uint32_t robot = 0;
        Fault fault = Fault::kCut;
    };
    /// Pre  !is_empty()
    [[nodiscard]] Event next();

private:
    [[nodiscard]] double uniform(); // [0, 1)

    std::array<double, kFaultKinds> rates_{}; // a second, of all robots
    double per_second_ = 0.0;
    std::uint32_t robots_;
    std::mt19937_64 random_;
};

} // namespace scanloom::load
