#include "tests/fault/broken_database_logs.hpp"

#include "server/store/postgres_connection.hpp"
#include "server/store/postgres_segments.hpp"
#include "tests/fault/passing_log.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

namespace scanloom::fault {
namespace {

using store::SessionId;
namespace postgres = store::postgres;

class UsurpingLog final : public PassingLog {
public:
    UsurpingLog(std::unique_ptr<store::ScanLog> log, const std::string& address)
        : PassingLog(std::move(log)), place_(postgres::parse_place(address).value()) {}

    void append(SessionId session, Revision first, std::vector<std::string> entries, Done done) override {
        const auto copy = entries;
        under().append(session, first, std::move(entries), [=, this, done = std::move(done)](Result<> appended) {
            if (!appended && appended.error().code == Errc::kNotOwner) appended = overwrite(session, first, copy);
            done(std::move(appended));
        });
    }

private:
    [[nodiscard]] Result<> overwrite(SessionId session, Revision first, const std::vector<std::string>& entries) const {
        auto connection = postgres::Connection::open(place_);
        if (!connection) return connection.error();
        for (const auto& segment : postgres::segments_of(session, first, entries)) {
            postgres::Parameters parameters;
            parameters.add(postgres::signed_of(session));
            parameters.add(postgres::signed_of(segment.first));
            parameters.add(postgres::signed_of(segment.last));
            parameters.add(std::string_view(segment.body));
            const auto stored = connection->run(
                "WITH one AS (UPDATE scanloom.session SET end_rev = greatest(end_rev, $3) WHERE id = $1),"
                " gone AS (DELETE FROM scanloom.segment WHERE session = $1 AND last > $2 AND first <= $3 AND first <> "
                "$2)"
                " INSERT INTO scanloom.segment (session, first, last, body) VALUES ($1, $2, $3, $4)"
                " ON CONFLICT (session, first) DO UPDATE SET last = excluded.last, body = excluded.body",
                parameters);
            if (!stored) return stored.error();
        }
        return {};
    }

    postgres::Place place_;
};

class RetryingLog final : public PassingLog {
public:
    using PassingLog::PassingLog;

    void append(SessionId session, Revision first, std::vector<std::string> entries, Done done) override {
        const std::lock_guard lock(mutex_); // held until the append, so that appends keep their order
        if (!unanswered_.empty()) return unanswered_.push_back({session, first, std::move(entries), std::move(done)});
        begin({session, first, std::move(entries), std::move(done)});
    }
    [[nodiscard]] bool reopen() override {
        if (!PassingLog::reopen()) return false;
        const std::lock_guard lock(mutex_);
        for (Append& append : std::exchange(unanswered_, {})) {
            if (const auto end = under().end_of(append.session); end && ahead_of(append) <= *end) {
                ahead_[append.session] = *end + 1 - append.first;
            }
            begin(std::move(append));
        }
        return true;
    }

private:
    [[nodiscard]] Revision ahead_of(const Append& append) { return append.first + ahead_[append.session]; }

    void begin(Append append) {
        auto entries = append.entries;
        const auto first = ahead_of(append);
        const auto session = append.session;
        under().append(session, first, std::move(entries),
                       [this, append = std::move(append)](const Result<>& appended) {
                           if (appended || appended.error().code != Errc::kStoreFailed) return append.done(appended);
                           const std::lock_guard lock(mutex_);
                           unanswered_.push_back(append);
                       });
    }

    std::mutex mutex_;                         // guards the members below
    std::vector<Append> unanswered_;           // in order
    std::map<SessionId, std::uint64_t> ahead_; // entries that the session has no record of
};

} // namespace

std::unique_ptr<store::ScanLog> usurping_log(std::unique_ptr<store::ScanLog> log, const std::string& address) {
    return std::make_unique<UsurpingLog>(std::move(log), address);
}

std::unique_ptr<store::ScanLog> retrying_log(std::unique_ptr<store::ScanLog> log) {
    return std::make_unique<RetryingLog>(std::move(log));
}

} // namespace scanloom::fault
