#pragma once

#include "common/error/error.hpp"
#include "server/store/postgres_connection.hpp"
#include "server/store/scan_log.hpp"

#include <chrono>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace scanloom::store::postgres {

/// Reads sessions, entries and checkpoints, over connections that are kept for the next reader.
/// Threads: any; each reader has a connection of its own.
class Readers {
public:
    explicit Readers(Place place) : place_(std::move(place)) {}

    /// Does `work` with a connection for reading.
    /// @param work  function of a Connection& that returns a Result
    /// Errors: those of `work`; kStoreFailed: no connection.
    template <class Work>
    [[nodiscard]] std::invoke_result_t<Work, Connection&> with_connection(const Work& work) {
        auto connection = take();
        if (!connection) return connection.error();
        auto done = work(*connection);
        if (connection->is_idle()) give_back(std::move(*connection));
        return done;
    }

    /// Returns all sessions that are not removed, by ascending id.
    [[nodiscard]] Result<std::vector<StoredSession>> sessions();

    /// Returns the last revision of a session, which its owner may be extending.
    /// Errors: kNotFound; kStoreFailed.
    [[nodiscard]] Result<Revision> end_of(SessionId session);

    /// Visits the entries after revision `after`, up to `end`.
    /// Errors: those of the visitor; kDataLoss: an entry is damaged or missing; kStoreFailed.
    [[nodiscard]] Result<> entries(SessionId session, Revision after, Revision end, const ScanLog::VisitEntry& visit);

    /// Visits all parts of a checkpoint, of one moment, by ascending key.
    /// Errors: those of the visitor; kDataLoss: a part is damaged; kStoreFailed.
    [[nodiscard]] Result<> checkpoint(SessionId session, const ScanLog::VisitPart& visit);

    /// Returns the size of the database's files a few seconds ago at most, bytes; 0 if it was never known.
    [[nodiscard]] std::uint64_t size();

    /// Closes the connections that are not in use.
    void close();

    /// Returns the error for a damaged log, which names the store.
    [[nodiscard]] Error damage(SessionId session, std::string_view what) const;

private:
    static constexpr std::size_t kIdleMax = 4;

    [[nodiscard]] Result<Connection> take();
    void give_back(Connection connection);
    [[nodiscard]] static Result<std::uint64_t> ask_size(Connection& connection);

    const Place place_;
    std::mutex mutex_; // guards the members below
    std::vector<Connection> idle_;
    std::uint64_t size_ = 0;
    std::optional<std::chrono::steady_clock::time_point> size_at_; // nullopt: not asked yet
};

} // namespace scanloom::store::postgres
