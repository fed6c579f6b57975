#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace scanloom::app {

/// Bounds on simultaneous connections; each connection takes a file descriptor.
struct ConnectionLimits {
    std::size_t robots = 10'000;
    std::size_t greeting = 256; ///< connections of robots that have not sent a hello yet
    std::size_t http = 1024;

    friend bool operator==(const ConnectionLimits&, const ConnectionLimits&) = default;
};

/// Raises the soft limit of file descriptors to the hard limit.
/// @return the soft limit after that
std::uint64_t allow_as_many_descriptors_as_possible();

/// Returns the connection limits that are possible with this many descriptors.
///
/// 350 of them are reserved for the store and the program itself: with none left, the store could not open its next
/// file. If the rest is too small for the default limits, three quarters of it are for robots.
[[nodiscard]] ConnectionLimits limits_within(std::uint64_t descriptors) noexcept;

/// Returns a warning for the operator if the descriptors do not suffice for the default limits; otherwise an empty
/// text.
[[nodiscard]] std::string shortage(std::uint64_t descriptors);

} // namespace scanloom::app
