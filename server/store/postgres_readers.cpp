#include "server/store/postgres_readers.hpp"

#include "server/store/postgres_segments.hpp"
#include "server/store/store_error.hpp"

#include <fmt/format.h>

#include <optional>
#include <string>
#include <utility>

namespace scanloom::store::postgres {
namespace {

constexpr std::chrono::seconds kSizeAge{10}; // of the size that size() returns

Result<> visit_parts(Connection& connection, SessionId session, const ScanLog::VisitPart& visit) {
    constexpr int kPage = 100;
    std::optional<std::string> last;
    for (bool is_end = false; !is_end;) {
        Parameters parameters;
        parameters.add(signed_of(session));
        if (last) parameters.add(std::string_view(*last));
        const auto rows = connection.run(last ? "SELECT key, value FROM scanloom.part WHERE session = $1 AND key > $2"
                                                " ORDER BY key LIMIT 100"
                                              : "SELECT key, value FROM scanloom.part WHERE session = $1"
                                                " ORDER BY key LIMIT 100",
                                         parameters, Connection::kReadTimeout);
        if (!rows) return rows.error();
        for (int row = 0; row < rows->size(); ++row) {
            last = std::string(rows->bytes(row, 0));
            const auto value = unsealed_part(session, *last, rows->bytes(row, 1));
            if (!value) return value.error();
            if (auto visited = visit(*last, *value); !visited) return visited;
        }
        is_end = rows->size() < kPage;
    }
    return {};
}

} // namespace

Result<Connection> Readers::take() {
    {
        const std::lock_guard lock(mutex_);
        while (!idle_.empty()) {
            Connection connection = std::move(idle_.back());
            idle_.pop_back();
            if (connection.is_alive()) return connection;
        }
    }
    return Connection::open(place_);
}

void Readers::give_back(Connection connection) {
    const std::lock_guard lock(mutex_);
    if (idle_.size() < kIdleMax) idle_.push_back(std::move(connection));
}

void Readers::close() {
    const std::lock_guard lock(mutex_);
    idle_.clear();
}

Error Readers::damage(SessionId session, std::string_view what) const {
    return {Errc::kDataLoss,
            fmt::format("the store {} is damaged: {} of session {}; restore the database from a backup, "
                        "or remove the session",
                        place_.text, what, session)};
}

Result<std::vector<StoredSession>> Readers::sessions() {
    return with_connection([](Connection& connection) -> Result<std::vector<StoredSession>> {
        const auto rows = connection.run("SELECT id, record FROM scanloom.session WHERE NOT removed ORDER BY id", {},
                                         Connection::kReadTimeout);
        if (!rows) return rows.error();
        std::vector<StoredSession> sessions;
        for (int row = 0; row < rows->size(); ++row) {
            sessions.push_back({static_cast<SessionId>(rows->number(row, 0)), std::string(rows->bytes(row, 1))});
        }
        return sessions;
    });
}

Result<Revision> Readers::end_of(SessionId session) {
    return with_connection([&](Connection& connection) -> Result<Revision> {
        Parameters parameters;
        parameters.add(signed_of(session));
        const auto rows = connection.run("SELECT end_rev FROM scanloom.session WHERE id = $1 AND NOT removed",
                                         parameters, Connection::kReadTimeout);
        if (!rows) return rows.error();
        if (rows->size() == 0) return no_such_session(session);
        return static_cast<Revision>(rows->number(0, 0));
    });
}

Result<> Readers::entries(SessionId session, Revision after, Revision end, const ScanLog::VisitEntry& visit) {
    const auto missing = [&](Revision revision) {
        return damage(session, fmt::format("the entry of revision {} is missing", revision));
    };
    return with_connection([&](Connection& connection) -> Result<> {
        for (Revision next = after + 1; next <= end;) {
            Parameters parameters;
            parameters.add(signed_of(session));
            parameters.add(signed_of(next));
            parameters.add(signed_of(end));
            const auto rows = connection.run(
                "SELECT first, last, body FROM scanloom.segment WHERE session = $1 AND first <= $3 AND first >="
                " coalesce((SELECT max(first) FROM scanloom.segment WHERE session = $1 AND first <= $2), $2)"
                " ORDER BY first LIMIT 200",
                parameters, Connection::kReadTimeout);
            if (!rows) return rows.error();
            if (rows->size() == 0) return missing(next);
            for (int row = 0; row < rows->size() && next <= end; ++row) {
                const auto first = static_cast<Revision>(rows->number(row, 0));
                const auto last = static_cast<Revision>(rows->number(row, 1));
                if (first > next || last < next) return missing(next);
                const auto visited = visit_entries(session, first, last, rows->bytes(row, 2), next - 1, visit);
                if (!visited) return visited.error();
                if (*visited == Visit::kStop) return {};
                next = last + 1;
            }
        }
        return {};
    });
}

Result<> Readers::checkpoint(SessionId session, const ScanLog::VisitPart& visit) {
    return with_connection([&](Connection& connection) -> Result<> {
        if (auto begun = connection.run("BEGIN ISOLATION LEVEL REPEATABLE READ READ ONLY"); !begun)
            return begun.error();
        auto visited = visit_parts(connection, session, visit);
        const auto ended = connection.run("COMMIT");
        if (!visited) return visited;
        return ended ? Result<>() : Result<>(ended.error());
    });
}

std::uint64_t Readers::size() {
    const auto now = std::chrono::steady_clock::now();
    {
        const std::lock_guard lock(mutex_);
        if (size_at_ && now - *size_at_ < kSizeAge) return size_;
        size_at_ = now;
    }
    const auto size = with_connection(ask_size);
    const std::lock_guard lock(mutex_);
    if (size) size_ = *size;
    return size_;
}

Result<std::uint64_t> Readers::ask_size(Connection& connection) {
    const auto rows = connection.run("SELECT pg_database_size(current_database())", {}, Connection::kReadTimeout);
    if (!rows) return rows.error();
    return static_cast<std::uint64_t>(rows->number(0, 0));
}

} // namespace scanloom::store::postgres
