#include "server/store/postgres_sweeper.hpp"

#include <array>
#include <utility>

namespace scanloom::store::postgres {
namespace {

// Each deletes a slice and returns how many rows it had. A session's own row goes last.
constexpr std::array kSlices = {
    "WITH gone AS (DELETE FROM scanloom.segment WHERE (session, first) IN (SELECT g.session, g.first"
    " FROM scanloom.segment g JOIN scanloom.session s ON s.id = g.session WHERE s.removed LIMIT 10000) RETURNING 1)"
    " SELECT count(*) FROM gone",
    "WITH gone AS (DELETE FROM scanloom.part WHERE (session, key) IN (SELECT p.session, p.key"
    " FROM scanloom.part p JOIN scanloom.session s ON s.id = p.session WHERE s.removed LIMIT 10000) RETURNING 1)"
    " SELECT count(*) FROM gone",
    "WITH gone AS (DELETE FROM scanloom.session s WHERE s.removed"
    " AND NOT EXISTS (SELECT FROM scanloom.segment WHERE session = s.id)"
    " AND NOT EXISTS (SELECT FROM scanloom.part WHERE session = s.id) RETURNING 1) SELECT 0::bigint FROM gone LIMIT 1",
};

} // namespace

Sweeper::Sweeper(Place place) : place_(std::move(place)), thread_([this](const std::stop_token& stop) { run(stop); }) {}

void Sweeper::wake() {
    {
        const std::lock_guard lock(mutex_);
        is_awake_ = true;
    }
    waiting_.notify_one();
}

void Sweeper::run(const std::stop_token& stop) {
    for (;;) {
        {
            std::unique_lock lock(mutex_);
            if (!waiting_.wait(lock, stop, [this] { return is_awake_; })) return;
            is_awake_ = false;
        }
        sweep(stop);
    }
}

/// Ends early if the database cannot be used: the next removal, or the next server, goes on.
void Sweeper::sweep(const std::stop_token& stop) {
    auto connection = Connection::open(place_);
    if (!connection) return;
    for (const char* slice : kSlices) {
        for (std::int64_t deleted = 1; deleted > 0;) {
            if (stop.stop_requested()) return;
            const auto rows = connection->run(slice, {}, Connection::kLongTimeout);
            if (!rows) return;
            deleted = rows->size() > 0 ? rows->number(0, 0) : 0;
        }
    }
}

} // namespace scanloom::store::postgres
