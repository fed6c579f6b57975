#pragma once

#include "server/live/live_config.hpp"
#include "server/store/scan_log.hpp"

#include <cstddef>
#include <map>
#include <memory>
#include <mutex>

namespace scanloom::live {

/// How many viewers there may be, in all and of one session. Nobody waits for a seat: who gets none says so.
/// Thread  any.
class Seats {
public:
    explicit Seats(const LiveConfig& config)
        : taken_(std::make_shared<Taken>()), max_(config.viewers_max), max_of_session_(config.viewers_per_session_max) {
    }

    /// A seat, free again when its last copy is gone; null when all are taken.
    [[nodiscard]] std::shared_ptr<const void> try_take(store::SessionId session) const;

private:
    struct Taken {
        std::mutex mutex;
        std::map<store::SessionId, std::size_t> by_session;
        std::size_t count = 0;

        void give_back(store::SessionId session);
    };

    std::shared_ptr<Taken> taken_; // outlives the seats
    std::size_t max_;
    std::size_t max_of_session_;
};

} // namespace scanloom::live
