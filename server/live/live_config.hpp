#pragma once

#include <chrono>
#include <cstddef>

namespace scanloom::live {

/// What bounds viewers: numbers, sizes, deadlines.
struct LiveConfig {
    std::size_t viewers_max = 1000;            ///< in all; one more is answered 503
    std::size_t viewers_per_session_max = 512; ///< likewise
    std::size_t request_bytes_max = 64 * 1024; ///< a longer message closes the connection
    int send_buffer_bytes = 64 * 1024; ///< of the socket (the system takes twice as many): what lies there grows old

    std::chrono::milliseconds interval{50};           ///< from one event to the next, at least
    std::chrono::milliseconds landmarks_pause{1'000}; ///< of a session: from one search for landmarks to the next
    std::chrono::milliseconds landmarks_turn{
        1'000};                                  ///< of a search through a long log; the next one goes on from there
    std::chrono::milliseconds handshake{30'000}; ///< for a handshake of the WebSocket
    std::chrono::milliseconds idle{300'000};     ///< without a sign of life; a ping asks for one after half of it
    std::chrono::milliseconds write{30'000};     ///< in which an event must have gone out
    std::chrono::milliseconds farewell{1'000};   ///< for the event under way, and for the viewer to hang up
};

} // namespace scanloom::live
