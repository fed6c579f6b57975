#pragma once

#include "server/live/live_config.hpp"
#include "server/store/scan_log.hpp"

#include <cstddef>
#include <map>
#include <memory>
#include <mutex>

namespace scanloom::live {

/// Semaphore that limits the number of viewers, in total and per session. try_take() does not wait.
/// Threads: any thread.
class Seats {
public:
    explicit Seats(const LiveConfig& config)
        : taken_(std::make_shared<Taken>()), max_(config.viewers_max), max_of_session_(config.viewers_per_session_max) {
    }

    /// Takes a slot, which is released when the last copy of the pointer is destroyed. @return null if all are taken
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
