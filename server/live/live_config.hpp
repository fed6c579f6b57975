#pragma once

#include <chrono>
#include <cstddef>

namespace scanloom::live {

/// Limits of viewers: numbers, sizes and timeouts.
struct LiveConfig {
    std::size_t viewers_max = 1000;             ///< in total; another one gets the status 503
    std::size_t viewers_per_session_max = 512;  ///< another one gets the status 503
    std::size_t request_bytes_max = 256 * 1024; ///< a longer message closes the connection
    int send_buffer_bytes = 64 * 1024;          ///< of the socket (the system doubles it); small, so events stay recent

    std::chrono::milliseconds interval{50};           ///< minimum time between two turns
    std::chrono::milliseconds landmarks_pause{1'000}; ///< of a session: between two searches for landmarks
    std::chrono::milliseconds landmarks_turn{1'000};  ///< maximum time of a search; the next one continues there
    std::chrono::milliseconds handshake{30'000};      ///< for the WebSocket handshake
    std::chrono::milliseconds idle{300'000};          ///< without received data; a ping is sent after half of it
    std::chrono::milliseconds write{30'000};          ///< for sending the messages of a turn
    std::chrono::milliseconds farewell{1'000};        ///< for the current message and the closing handshake
};

} // namespace scanloom::live
