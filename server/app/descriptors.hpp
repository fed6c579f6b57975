#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace scanloom::app {

/// How many connections there may be at once; every one takes a file descriptor.
struct ConnectionLimits {
    std::size_t robots = 10'000;
    std::size_t greeting = 256; ///< robots' connections on which no hello was said yet
    std::size_t http = 1024;

    friend bool operator==(const ConnectionLimits&, const ConnectionLimits&) = default;
};

/// Raises the soft limit of file descriptors to the hard one. Returns what it is now.
std::uint64_t allow_as_many_descriptors_as_possible();

/// What is possible with so many descriptors, of which the store and the program itself keep 350: with none left, the
/// store could not open its next file. Three quarters of a short supply are the robots'.
[[nodiscard]] ConnectionLimits limits_within(std::uint64_t descriptors) noexcept;

/// What to tell whoever runs the server with fewer connections than wished for; empty when nothing is short.
[[nodiscard]] std::string shortage(std::uint64_t descriptors);

} // namespace scanloom::app
