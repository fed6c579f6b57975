#pragma once

#include "server/store/scan_log.hpp"

#include <chrono>
#include <cstddef>
#include <map>
#include <memory>
#include <mutex>

namespace scanloom::live {

/// Limits of viewers: numbers, sizes and timeouts.
struct LiveConfig {
    std::size_t viewers_max = 1000;            ///< in total; another one gets the status 503
    std::size_t viewers_per_session_max = 512; ///< another one gets the status 503
    std::size_t request_bytes_max = 64 * 1024; ///< a longer message closes the connection
    int send_buffer_bytes = 64 * 1024;         ///< of the socket (the system doubles it); small, so events stay recent

    std::chrono::milliseconds interval{50};           ///< minimum time between two events
    std::chrono::milliseconds landmarks_pause{1'000}; ///< of a session: between two searches for landmarks
    std::chrono::milliseconds landmarks_turn{1'000};  ///< maximum time of a search; the next one continues there
    std::chrono::milliseconds handshake{30'000};      ///< for the WebSocket handshake
    std::chrono::milliseconds idle{300'000};          ///< without received data; a ping is sent after half of it
    std::chrono::milliseconds write{30'000};          ///< for sending one event
    std::chrono::milliseconds farewell{1'000};        ///< for the current event and the closing handshake
};

/// Semaphore that limits the number of viewers, in total and per session.
/// Threads: any thread.
class ViewerSemaphore {
public:
    explicit ViewerSemaphore(const LiveConfig& config)
        : taken_(std::make_shared<Taken>()), max_(config.viewers_max), max_of_session_(config.viewers_per_session_max) {
    }

    /// Takes a slot, which is released when the last copy of the pointer is destroyed. Does not wait.
    /// @return null if all slots are taken
    [[nodiscard]] std::shared_ptr<const void> try_take(store::SessionId session) const;

private:
    struct Taken {
        std::mutex mutex;
        std::map<store::SessionId, std::size_t> by_session;
        std::size_t count = 0;

        void give_back(store::SessionId session);
    };

    std::shared_ptr<Taken> taken_; // kept alive by the slots
    std::size_t max_;
    std::size_t max_of_session_;
};

} // namespace scanloom::live
