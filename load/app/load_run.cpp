#include "load/app/load_run.hpp"

#include "common/net/await_tuple.hpp"
#include "load/core/figure_text.hpp"
#include "load/net/server_api.hpp"
#include "load/net/verification.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include <sys/resource.h>
#include <unistd.h>

namespace scanloom::load {

namespace asio = boost::asio;

namespace {

constexpr Micros kPollPeriod = 100 * kMillisecond;
constexpr Micros kShowPeriod = kSecond;
constexpr Micros kHeadStart = 200 * kMillisecond; ///< from notifying the robots until they start
constexpr std::chrono::seconds kTimeout{60};      ///< with the server's HTTP when it is no longer under load
constexpr std::string_view kReference = "calm";

double in_seconds(const timeval& time) {
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) * 1e-6;
}

/// Returns CPU time and memory used by this process so far.
ProcessUse own_use() {
    rusage use{};
    getrusage(RUSAGE_SELF, &use);
    std::ifstream file("/proc/self/statm"); // unit: pages; all, then resident ones
    double all = 0.0;
    double resident = 0.0;
    file >> all >> resident;
    return {in_seconds(use.ru_utime) + in_seconds(use.ru_stime), resident * static_cast<double>(sysconf(_SC_PAGESIZE))};
}

std::string prefix_of(const LoadOptions& options) { return fmt::format("load-{}-", options.seed); }

std::vector<std::string> session_names(const LoadOptions& options) {
    std::vector<std::string> names;
    for (std::uint32_t i = 0; i < options.sessions; ++i) names.push_back(prefix_of(options) + std::to_string(i));
    return names;
}

/// Whether a run of this program creates such names. Other sessions with the same prefix are not its own.
bool is_ours(std::string_view name, std::string_view prefix) {
    const auto rest = name.substr(prefix.size());
    return rest == kReference || std::ranges::all_of(rest, [](char c) { return c >= '0' && c <= '9'; });
}

FleetPlan fleet_plan(const LoadOptions& options) {
    return {.robots = options.robots,
            .connections_per_second = options.connections_per_second,
            .scans = options.rate > 0.0 ? Schedule::scans_within(options.duration, options.rate) : 0,
            .duration = static_cast<Micros>(options.duration * static_cast<double>(kSecond)),
            .faults = options.faults,
            .seed = options.seed,
            .threads = std::min(options.threads, options.robots)};
}

} // namespace

LoadRun::LoadRun(asio::io_context& io, const LoadOptions& options, const Workload& workload,
                 const RobotLinkOptions& link, const net::HttpPlace& http, Console& console)
    : io_(io), options_(options), workload_(workload), link_(link), console_(console),
      sessions_(session_names(options)), robots_(spread_over(sessions_, options.robots, workload.scans.size())),
      http_(io.get_executor(), http), fleet_(fleet_plan(options), robots_, clock_, workload_, link_),
      audience_({options.viewers, options.tile_readers, options.tile_rate, http, sessions_}, clock_) {
    report_.settings = static_cast<const RunSettings&>(options);
    report_.settings.beams = workload.beams;
    report_.evidence.verify = options.verify;
    report_.evidence.sessions = options.sessions;
    report_.evidence.shares_sessions = options.sessions < options.robots;
}

bool LoadRun::needs_http() const noexcept {
    return options_.verify != Verify::kNone || options_.viewers > 0 || options_.tile_readers > 0;
}

std::string LoadRun::reference_name() const { return prefix_of(options_) + std::string(kReference); }

void LoadRun::interrupt() {
    interrupted_ = true;
    fleet_.end();
}

asio::awaitable<Result<RunReport>> LoadRun::conduct() {
    const auto room = co_await make_room();
    if (!room) co_return room.error();
    const bool all_there = co_await connect_robots();
    if (all_there && !interrupted_) co_await stream();
    const auto last = fleet_.look();
    report_.audience = *audience_.look();
    audience_.stop();
    fleet_.stop();
    report_.fleet = last->figures;
    Evidence& evidence = report_.evidence;
    evidence.scans_sent = last->figures.scans_sent;
    evidence.scans_acknowledged = last->figures.scans_acknowledged;
    evidence.scans_lost = last->figures.scans_lost;
    evidence.failures = last->troubles.failures;
    if (evidence.scans_sent == 0) {
        evidence.failures.push_back(why_nothing_was_sent(last->troubles.newest));
    }
    if (evidence.scans_acknowledged < evidence.scans_sent && !last->troubles.newest.empty()) {
        evidence.failures.push_back(last->troubles.newest);
    }
    co_await verify();
    co_await clean_up();
    report_.verdict = verdict_on(evidence);
    console_.clear();
    co_return report_;
}

std::string LoadRun::why_nothing_was_sent(const std::string& trouble) const {
    if (interrupted_) return "interrupted before the first scan";
    if (!trouble.empty()) return trouble;
    return fmt::format("within {:g} s the server admitted no robot, or granted none any credit",
                       options_.give_up_after);
}

// Before --------------------------------------------------------------------------------------------------------------

asio::awaitable<Result<>> LoadRun::make_room() {
    const auto prefix = prefix_of(options_);
    auto names = co_await sessions_of(http_, prefix);
    if (!names) {
        if (needs_http()) co_return names.error();
        co_return Result<>();
    }
    std::erase_if(*names, [&](const std::string& name) { return !is_ours(name, prefix); });
    if (names->empty()) co_return Result<>();
    if (!options_.replace) {
        co_return Error{
            Errc::kAlreadyExists,
            fmt::format("{} of an earlier run with --seed {} {} on the server, {} first; delete {} with --replace, or "
                        "use another --seed",
                        names->size() == 1 ? "a session" : fmt::format("{} sessions", grouped(names->size())),
                        options_.seed, names->size() == 1 ? "is" : "are", names->front(),
                        names->size() == 1 ? "it" : "them")};
    }
    for (const auto& name : *names) {
        console_.passing(fmt::format("deleting {}", name));
        const auto deleted = co_await delete_session(http_, name);
        if (!deleted) co_return deleted.error();
    }
    co_return Result<>();
}

/// @return false if a robot gave up, or no more robots connected
asio::awaitable<bool> LoadRun::connect_robots() {
    fleet_.connect();
    const auto timeout = static_cast<Micros>(options_.give_up_after * static_cast<double>(kSecond));
    std::uint32_t greeted = 0;
    Micros advanced = clock_.now();
    for (;;) {
        const auto progress = fleet_.progress();
        console_.passing(fmt::format("{} of {} robots connected{}", grouped(progress.linked), grouped(options_.robots),
                                     progress.trouble.empty() ? "" : "; " + progress.trouble));
        if (progress.greeted == options_.robots) co_return true;
        if (progress.failed > 0 || interrupted_) co_return false;
        if (std::exchange(greeted, progress.greeted) != progress.greeted) advanced = clock_.now();
        if (clock_.now() > advanced + timeout) co_return false;
        co_await pause(kPollPeriod);
    }
}

// While they stream ---------------------------------------------------------------------------------------------------

asio::awaitable<void> LoadRun::stream() {
    const Moment before = co_await moment();
    begun_ = clock_.now() + kHeadStart;
    fleet_.begin(begun_);
    audience_.begin();
    co_await wait_for_the_last_ack();
    const Moment after = co_await moment();
    report_.seconds = std::max(in_seconds(after.fleet.last_ack - begun_), 1e-3);
    report_.watched_seconds = in_seconds(after.at - before.at);
    report_.own = {after.own.cpu_seconds - before.own.cpu_seconds, after.own.resident_bytes};
    report_.server = used_between(before.server, after.server);
}

asio::awaitable<void> LoadRun::wait_for_the_last_ack() {
    const auto timeout = static_cast<Micros>(options_.give_up_after * static_cast<double>(kSecond));
    const Micros end = begun_ + static_cast<Micros>(options_.duration * static_cast<double>(kSecond));
    Moment shown = co_await moment();
    std::uint64_t acknowledged = 0;
    Micros advanced = begun_;
    for (;;) {
        co_await pause(kPollPeriod);
        const auto progress = fleet_.progress();
        const Micros now = clock_.now();
        if (progress.finished + progress.failed == options_.robots) co_return;
        const std::uint64_t before = std::exchange(acknowledged, progress.scans_acknowledged);
        if (acknowledged > before || (now < end && !interrupted_)) advanced = now;
        if (now > advanced + timeout) co_return;
        if (now < shown.at + kShowPeriod) continue;
        Moment next = co_await moment();
        show(shown, next);
        shown = std::move(next);
    }
}

asio::awaitable<Moment> LoadRun::moment() {
    Moment now;
    http_.set_timeout(std::chrono::seconds(2)); // a slow server must not stop the display
    const auto use = co_await server_use(http_);
    http_.set_timeout(kTimeout);
    if (use) now.server = *use;
    now.fleet = fleet_.look()->figures;
    now.audience = *audience_.look();
    now.own = own_use();
    now.at = clock_.now();
    co_return now;
}

asio::awaitable<void> LoadRun::pause(Micros time) {
    asio::steady_timer timer(io_);
    timer.expires_after(std::chrono::microseconds(time));
    co_await timer.async_wait(kAwaitTuple);
}

void LoadRun::show(const Moment& before, const Moment& now) {
    if (console_.is_terminal()) {
        console_.progress(fmt::format("{}", fmt::join(live_table(report_.settings, begun_, before, now), "\n")));
    } else {
        console_.note(live_line(report_.settings, begun_, before, now));
    }
}

// Afterwards ----------------------------------------------------------------------------------------------------------

std::vector<ExpectedSession> LoadRun::expected() const {
    std::vector<ExpectedSession> sessions;
    for (const auto& name : sessions_) sessions.push_back({name, {}});
    const auto acknowledged = fleet_.acknowledged();
    for (const RobotPlan& robot : robots_) {
        sessions[robot.index % sessions.size()].robots.push_back({robot.name, acknowledged[robot.index]});
    }
    return sessions;
}

asio::awaitable<void> LoadRun::verify() {
    Evidence& evidence = report_.evidence;
    const bool is_complete = evidence.failures.empty() && evidence.scans_acknowledged == evidence.scans_sent;
    if (options_.verify == Verify::kNone || !is_complete) co_return; // scans in flight may still arrive
    const auto report = [this](const std::string& text) { console_.passing(text); };
    const auto sessions = expected();
    co_await verify_counts(http_, sessions, report, evidence);
    const bool compare = options_.verify == Verify::kDigests && !evidence.shares_sessions;
    if (!compare || !evidence.failures.empty()) co_return;
    reference_ = std::make_unique<ReferenceSession>(io_, reference_name(), clock_, workload_, link_);
    co_await verify_digests(http_, sessions, reference_name(), *reference_, report, evidence);
}

asio::awaitable<void> LoadRun::clean_up() {
    if (options_.keep) co_return;
    auto names = sessions_;
    if (reference_) names.push_back(reference_name());
    for (std::size_t i = 0; i < names.size(); ++i) {
        console_.passing(fmt::format("deleting {} of {} sessions", grouped(i), grouped(names.size())));
        const auto deleted = co_await delete_session(http_, names[i]);
        if (deleted) continue;
        console_.note(fmt::format("the sessions from {} remain on the server: {}", names[i], deleted.error().message));
        co_return;
    }
}

} // namespace scanloom::load
