#include "server/store/postgres_connection.hpp"

#include "server/store/store_error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <libpq-fe.h>

#include <poll.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <optional>
#include <random>
#include <set>

namespace scanloom::store::postgres {
namespace {

using Clock = std::chrono::steady_clock;

// Object ids of pg_type, which never change.
constexpr unsigned kBytea = 17;
constexpr unsigned kBigint = 20;
constexpr unsigned kByteaArray = 1001;
constexpr unsigned kBigintArray = 1016;

constexpr int kVersionMin = 150'000;

template <class Number>
void append_big_endian(std::string& to, Number number) {
    for (int shift = 8 * static_cast<int>(sizeof number) - 8; shift >= 0; shift -= 8) {
        to += static_cast<char>(static_cast<std::uint64_t>(number) >> shift);
    }
}

/// Returns the header of a binary array with one dimension.
std::string array_of(unsigned type, std::size_t count) {
    std::string bytes;
    for (const std::size_t number : {std::size_t{1}, std::size_t{0}, std::size_t{type}, count, std::size_t{1}}) {
        append_big_endian(bytes, static_cast<std::uint32_t>(number)); // dimensions, nulls, type, size, first index
    }
    return bytes;
}

/// Returns the error code for an SQLSTATE.
Errc code_of_state(std::string_view state) {
    if (state == "53100") return Errc::kOverloaded; // disk_full
    if (state == "55P03") return Errc::kConflict;   // lock_not_available
    return Errc::kStoreFailed;
}

/// Returns what to do about an SQLSTATE, if the user can do something.
std::string_view advice_for(std::string_view state) {
    if (state == "53100") return "; make room on its disk";
    if (state == "42501") return "; give the user that --store names all rights on the schema scanloom"; // privileges
    return "";
}

/// Parameters as libpq takes them. They use the bytes of `parameters`.
struct Values {
    int count;
    std::vector<const char*> values;
    std::vector<int> lengths;
    std::vector<int> formats;
};

Values values_of(const Parameters& parameters) {
    Values made{static_cast<int>(parameters.size()), {}, {}, std::vector<int>(parameters.size(), 1)};
    for (const std::string& value : parameters.values()) {
        made.values.push_back(value.data());
        made.lengths.push_back(static_cast<int>(value.size()));
    }
    return made;
}

/// Waits until a socket is ready. @return false after the deadline
bool wait_for(int socket, short events, Clock::time_point deadline) {
    for (;;) {
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
        if (left <= 0) return false;
        pollfd descriptor{socket, events, 0};
        const int ready = ::poll(&descriptor, 1, static_cast<int>(std::min<std::int64_t>(left, 60'000)));
        if (ready > 0) return true;
        if (ready < 0 && errno != EINTR) return false;
    }
}

} // namespace

void Parameters::add(std::int64_t number) {
    append_big_endian(values_.emplace_back(), number);
    types_.push_back(kBigint);
}

void Parameters::add(std::string_view bytes) {
    values_.emplace_back(bytes);
    types_.push_back(kBytea);
}

void Parameters::add(std::span<const std::int64_t> numbers) {
    std::string& bytes = values_.emplace_back(array_of(kBigint, numbers.size()));
    for (const std::int64_t number : numbers) {
        append_big_endian(bytes, static_cast<std::uint32_t>(sizeof number));
        append_big_endian(bytes, number);
    }
    types_.push_back(kBigintArray);
}

void Parameters::add(std::span<const std::string_view> byte_strings) {
    std::string& bytes = values_.emplace_back(array_of(kBytea, byte_strings.size()));
    for (const std::string_view one : byte_strings) {
        append_big_endian(bytes, static_cast<std::uint32_t>(one.size()));
        bytes += one;
    }
    types_.push_back(kByteaArray);
}

void Rows::Clear::operator()(pg_result* result) const { PQclear(result); }

int Rows::size() const { return PQntuples(result_.get()); }

std::int64_t Rows::number(int row, int column) const {
    std::uint64_t number = 0;
    for (const char byte : bytes(row, column)) number = number << 8 | static_cast<unsigned char>(byte);
    return static_cast<std::int64_t>(number);
}

std::string_view Rows::bytes(int row, int column) const {
    return {PQgetvalue(result_.get(), row, column), static_cast<std::size_t>(PQgetlength(result_.get(), row, column))};
}

struct Connection::State {
    struct Finish {
        void operator()(PGconn* connection) const { PQfinish(connection); }
    };

    std::unique_ptr<PGconn, Finish> connection;
    std::string host;
    std::string warning;            // of the statement that runs
    std::set<const char*> prepared; // statements of run_prepared(), by their addresses

    [[nodiscard]] Error lost(std::string_view what) {
        return failure("the database on {}: {}; the connection was given up", host, what);
    }

    static void take_notice(void* state, const PGresult* notice) {
        const char* severity = PQresultErrorField(notice, PG_DIAG_SEVERITY_NONLOCALIZED);
        const char* text = PQresultErrorField(notice, PG_DIAG_MESSAGE_PRIMARY);
        if (severity != nullptr && std::strcmp(severity, "WARNING") == 0) {
            static_cast<State*>(state)->warning = text == nullptr ? "a warning" : text;
        }
    }
};

Connection::Connection(std::unique_ptr<State> state) : state_(std::move(state)) {}
Connection::Connection(Connection&& other) noexcept = default;
Connection& Connection::operator=(Connection&& other) noexcept = default;
Connection::~Connection() = default;

Result<Connection> Connection::open(const Place& place) {
    std::vector<Place::Host> hosts = place.hosts;
    std::mt19937 random{std::random_device{}()};
    std::ranges::shuffle(hosts, random);
    std::vector<std::string> reasons;
    for (const auto& [name, port] : hosts) {
        std::vector<const char*> keywords{"host", "port", "fallback_application_name"};
        std::vector<const char*> values{name.c_str(), port.c_str(), "scanloom-server"};
        for (const auto& [keyword, value] : place.settings) {
            keywords.push_back(keyword.c_str());
            values.push_back(value.c_str());
        }
        keywords.push_back(nullptr);
        values.push_back(nullptr);
        auto state = std::make_unique<State>();
        state->host = fmt::format("{}{}{}", name.empty() ? "this machine" : name, port.empty() ? "" : ":", port);
        state->connection.reset(PQconnectStartParams(keywords.data(), values.data(), 0));
        PGconn* const connection = state->connection.get();
        if (connection == nullptr) return failure("there is no memory for a connection to {}", place.text);
        const auto deadline = Clock::now() + kConnectTimeout;
        PostgresPollingStatusType status = PGRES_POLLING_WRITING;
        bool is_late = false;
        while (!is_late && PQstatus(connection) != CONNECTION_BAD && status != PGRES_POLLING_OK &&
               status != PGRES_POLLING_FAILED) {
            const short events = status == PGRES_POLLING_READING ? POLLIN : POLLOUT;
            is_late = !wait_for(PQsocket(connection), events, deadline);
            if (!is_late) status = PQconnectPoll(connection);
        }
        if (is_late) {
            reasons.push_back(fmt::format("{} does not answer within {} ms", state->host, kConnectTimeout.count()));
            continue;
        }
        if (PQstatus(connection) != CONNECTION_OK) {
            reasons.push_back(one_line(PQerrorMessage(connection)));
            continue;
        }
        Connection opened(std::move(state));
        if (auto ready = opened.make_ready(); !ready) {
            if (ready.error().code == Errc::kUnsupportedVersion) return ready.error();
            reasons.push_back(ready.error().message);
            continue;
        }
        return opened;
    }
    return failure("the database {} cannot be used: {}; check that it runs, and the address, user and password that "
                   "--store and PGPASSFILE name",
                   place.text, fmt::join(reasons, "; "));
}

/// Refuses standbys and versions that are too old, and turns off what would cancel a statement: a commit that is
/// cancelled while it waits for a standby is reported as done.
Result<> Connection::make_ready() {
    PGconn* const connection = state_->connection.get();
    if (PQsetnonblocking(connection, 1) != 0) return failure("{}", one_line(PQerrorMessage(connection)));
    PQsetNoticeReceiver(connection, &State::take_notice, state_.get());
    if (const int version = PQserverVersion(connection); version < kVersionMin) {
        return Error{Errc::kUnsupportedVersion, fmt::format("{} has PostgreSQL {}; version 15 or a newer one is needed",
                                                            state_->host, version / 10'000)};
    }
    const auto rows =
        run("SELECT set_config('synchronous_commit', 'on', false), set_config('statement_timeout', '0', false),"
            " set_config('lock_timeout', '0', false), set_config('tcp_keepalives_idle', '5', false),"
            " set_config('tcp_keepalives_interval', '2', false), set_config('tcp_keepalives_count', '3', false),"
            " set_config('default_transaction_isolation', 'read committed', false),"
            " (pg_is_in_recovery() OR current_setting('default_transaction_read_only')::bool)::int::bigint");
    if (!rows) return rows.error();
    if (rows->number(0, 7) != 0)
        return failure(
            "{} is read-only: it is a standby, or default_transaction_read_only is on; name the primary in --store",
            state_->host);
    return {};
}

Result<Rows> Connection::run(const char* sql, const Parameters& parameters, std::chrono::milliseconds timeout) {
    PGconn* const connection = state_->connection.get();
    const auto [count, values, lengths, formats] = values_of(parameters);
    state_->warning.clear();
    if (PQsendQueryParams(connection, sql, count, parameters.types().data(), values.data(), lengths.data(),
                          formats.data(), 1) == 0) {
        return state_->lost(one_line(PQerrorMessage(connection)));
    }
    return result_within(timeout);
}

Result<Rows> Connection::run_prepared(const char* sql, const Parameters& parameters) {
    PGconn* const connection = state_->connection.get();
    const auto name = fmt::format("s{}", fmt::ptr(sql));
    const auto [count, values, lengths, formats] = values_of(parameters);
    state_->warning.clear();
    if (!state_->prepared.contains(sql)) {
        if (PQsendPrepare(connection, name.c_str(), sql, count, parameters.types().data()) == 0) {
            return state_->lost(one_line(PQerrorMessage(connection)));
        }
        if (auto prepared = result_within(kWriteTimeout); !prepared) return prepared;
        state_->prepared.insert(sql);
    }
    if (PQsendQueryPrepared(connection, name.c_str(), count, values.data(), lengths.data(), formats.data(), 1) == 0) {
        return state_->lost(one_line(PQerrorMessage(connection)));
    }
    return result_within(kWriteTimeout);
}

/// Waits for the result of the statement that was sent.
Result<Rows> Connection::result_within(std::chrono::milliseconds timeout) {
    PGconn* const connection = state_->connection.get();
    const auto deadline = Clock::now() + timeout;
    const auto late = [&] { return state_->lost(fmt::format("no answer within {} ms", timeout.count())); };
    for (int left = 1; left != 0;) { // libpq reads while it writes, or both sides could wait for the other
        left = PQflush(connection);
        if (left < 0) return state_->lost(one_line(PQerrorMessage(connection)));
        if (left == 0) break;
        if (!wait_for(PQsocket(connection), POLLIN | POLLOUT, deadline)) return late();
        if (PQconsumeInput(connection) == 0) return state_->lost(one_line(PQerrorMessage(connection)));
    }
    std::optional<Error> failed;
    Rows rows;
    for (;;) { // until the server is ready for the next statement: a commit can fail after the rows were sent
        while (PQisBusy(connection) != 0) {
            if (!wait_for(PQsocket(connection), POLLIN, deadline)) return late();
            if (PQconsumeInput(connection) == 0) return state_->lost(one_line(PQerrorMessage(connection)));
        }
        PGresult* const result = PQgetResult(connection);
        if (result == nullptr) break;
        Rows received(result);
        const auto status = PQresultStatus(result);
        if (status == PGRES_TUPLES_OK || status == PGRES_COMMAND_OK) {
            rows = std::move(received);
            continue;
        }
        const char* state = PQresultErrorField(result, PG_DIAG_SQLSTATE);
        failed = Error{code_of_state(state == nullptr ? "" : state),
                       fmt::format("the database on {}: {}{}", state_->host, one_line(PQresultErrorMessage(result)),
                                   advice_for(state == nullptr ? "" : state))};
    }
    if (failed) return *failed;
    if (!state_->warning.empty()) return state_->lost(state_->warning);
    return rows;
}

bool Connection::is_alive() {
    PGconn* const connection = state_->connection.get();
    pollfd descriptor{PQsocket(connection), POLLIN, 0};
    while (::poll(&descriptor, 1, 0) > 0) { // notices, or the end of the connection
        if (PQconsumeInput(connection) == 0 || (descriptor.revents & (POLLHUP | POLLERR)) != 0) return false;
    }
    return PQstatus(connection) == CONNECTION_OK;
}

bool Connection::is_idle() const {
    const PGconn* const connection = state_->connection.get();
    return PQstatus(connection) == CONNECTION_OK && PQtransactionStatus(connection) == PQTRANS_IDLE;
}

Result<std::optional<std::string>> Connection::replication_fault() {
    const auto rows = run("SELECT current_setting('synchronous_standby_names'), current_setting('fsync'),"
                          " current_setting('full_page_writes')");
    if (!rows) return rows.error();
    const auto fault = [&](std::string_view what) {
        return fmt::format("the database on {} {}: an acknowledged scan could be lost", state_->host, what);
    };
    if (rows->bytes(0, 0).empty()) return fault("has no synchronous standby (synchronous_standby_names is empty)");
    if (rows->bytes(0, 1) != "on") return fault("has fsync = off");
    if (rows->bytes(0, 2) != "on") return fault("has full_page_writes = off");
    return std::optional<std::string>();
}

} // namespace scanloom::store::postgres
