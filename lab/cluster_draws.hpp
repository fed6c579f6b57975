#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace scanloom::lab::cluster {

/// What a random number is for. Numbers for different uses are independent.
enum class Use : std::uint64_t {
    kSessionName,
    kSessionSize,
    kSessionLife,
    kRobotStart,
    kRank,
    kBackoff,
    kFailure,
    kSilence,
    kRenewal,
};

/// Random numbers that depend only on their names, not on the order in which they are drawn. So an event does not
/// change what others draw.
class Draws {
public:
    explicit Draws(std::uint64_t seed) : seed_(seed) {}

    /// Returns 64 random bits.
    /// @param which  for example the number of a session
    /// @param count  how often this was drawn before
    [[nodiscard]] std::uint64_t bits(Use use, std::uint64_t which, std::uint64_t count = 0) const {
        return mixed(mixed(mixed(seed_ ^ static_cast<std::uint64_t>(use)) ^ which) ^ count);
    }

    /// Returns a number of the uniform distribution, from 0 to less than 1.
    [[nodiscard]] double unit(Use use, std::uint64_t which, std::uint64_t count = 0) const {
        return static_cast<double>(bits(use, which, count) >> 11U) * 0x1p-53;
    }

    /// Returns a number of the exponential distribution with this mean.
    [[nodiscard]] double exponential(double mean, Use use, std::uint64_t which, std::uint64_t count = 0) const {
        return -mean * std::log1p(-unit(use, which, count));
    }

    /// Returns a number of the normal distribution with mean 0 and deviation 1, by Box and Muller.
    [[nodiscard]] double normal(Use use, std::uint64_t which) const {
        const double radius = std::sqrt(exponential(2.0, use, which, 0));
        return radius * std::cos(2.0 * std::numbers::pi * unit(use, which, 1));
    }

private:
    /// Source: Steele, Lea, Flood, Fast splittable pseudorandom number generators, 2014 (SplitMix64).
    [[nodiscard]] static std::uint64_t mixed(std::uint64_t value) {
        value += 0x9E37'79B9'7F4A'7C15;
        value = (value ^ (value >> 30U)) * 0xBF58'476D'1CE4'E5B9;
        value = (value ^ (value >> 27U)) * 0x94D0'49BB'1331'11EB;
        return value ^ (value >> 31U);
    }

    std::uint64_t seed_;
};

} // namespace scanloom::lab::cluster
