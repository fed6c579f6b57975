#include "server/http/handlers/lookup.hpp"

#include "common/net/await_tuple.hpp"
#include "server/http/handlers/weave_request.hpp"
#include "server/http/text.hpp"

#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/this_coro.hpp>
#include <fmt/format.h>

#include <string_view>

namespace scanloom::http {

std::optional<Error> damage_of(const sessions::SessionRegistry& sessions, const std::string& name) {
    const auto damaged = sessions.damaged();
    if (const auto found = damaged.find(name); found != damaged.end()) {
        if (found->second.code == Errc::kOverloaded) { // the session itself is intact
            return Error{Errc::kOverloaded,
                         fmt::format("the session {} is not loaded: {}", name, found->second.message)};
        }
        return Error{Errc::kDataLoss,
                     fmt::format("the session {} could not be recovered: {}; a retry does not help, DELETE removes it",
                                 name, found->second.message)};
    }
    return std::nullopt;
}

Result<sessions::ListedSession> find_listed(const Context& context) {
    const auto& sessions = context.services.sessions;
    const auto& name = context.arguments["session"];
    if (auto listed = sessions.listed(name)) return *std::move(listed);
    return damage_of(sessions, name).value_or(sessions::no_such_session(name));
}

std::string session_tag(const sessions::SessionInfo& info, const MakingVersions& versions) {
    const auto tag = fmt::format("{}-{}.{}", sessions::tag_of(info), versions.projection, versions.rendering);
    return tag_with(tag, *info.exclusions);
}

std::string tag_with(std::string_view tag, const Exclusions& exclusions) {
    return exclusions.revision() == 0 ? std::string(tag) : fmt::format("{}-x{}", tag, exclusions.revision());
}

namespace {

constexpr std::string_view kWeave = "weave";
constexpr std::string_view kWith = "with";

/// Returns the maps of a replay job, or the reason why it has none.
Result<Maps> maps_of(std::shared_ptr<sessions::Session> session, const std::shared_ptr<sessions::ReplayJob>& weave,
                     std::shared_ptr<const mapping::Snapshot> maps) {
    if (maps) {
        auto tag = fmt::format("{}-{}", session_tag(session->info()), weave->id());
        tag = tag_with(tag, *maps->exclusions);
        if (const auto corrected = maps->scan_poses.corrected(); corrected > 0) tag += fmt::format("-c{}", corrected);
        return Maps{std::move(session), std::move(maps), weave, std::move(tag)};
    }
    const auto progress = weave->progress();
    if (progress.error) return *progress.error;
    const auto earlier =
        progress.revision ? fmt::format(", or use those with {} of them with weave={}", *progress.revision, weave->id())
                          : std::string();
    return Error{
        Errc::kOverloaded,
        fmt::format(
            "these maps are being computed, {} of {} entries are applied; retry soon, see weave/{} for the progress{}",
            progress.applied, progress.target, weave->id(), earlier)};
}

} // namespace

Result<std::shared_ptr<sessions::ReplayJob>> find_weave(sessions::ReplayJobs& weaves, const sessions::Session& session,
                                                        std::string_view id) {
    if (auto weave = weaves.find(session.info().id, id)) return weave;
    return Error{Errc::kNotFound,
                 fmt::format("the session has no replay job {}; start one with POST .../weave", in_quotes(id))};
}

namespace {

/// Returns the maps of the replay job that `parameter` names, or the session's own maps.
Result<Maps> chosen(const Context& context, std::string_view parameter, Waiting waiting = Waiting::kAllowed) {
    const auto& session = context.session;
    const auto id = context.query.find(parameter);
    if (!id) {
        auto snapshot = waiting == Waiting::kAllowed ? session->snapshot() : session->try_snapshot();
        return Maps{session, std::move(snapshot), session, session_tag(session->info())};
    }
    const auto weave = find_weave(context.services.weaves, *session, *id);
    if (!weave) return weave.error();
    return maps_of(session, *weave, (*weave)->maps());
}

/// Suspends the coroutine until the job has maps of `target` or has ended, at most for Services::replay_timeout.
boost::asio::awaitable<void> wait_for(Context& context, sessions::ReplayJob& weave, Revision target) {
    const WorkClass work = context.work;
    co_await context.run_on(WorkClass::kIo); // one thread at a time uses the timer
    const auto executor = co_await boost::asio::this_coro::executor;
    const auto timer = std::make_shared<boost::asio::steady_timer>(executor, context.services.replay_timeout);
    weave.notify(target, [timer, executor] { boost::asio::post(executor, [timer] { timer->cancel(); }); });
    co_await timer->async_wait(kAwaitTuple);
    co_await context.run_on(work);
}

boost::asio::awaitable<Result<Maps>> replayed(Context& context) {
    const auto& session = context.session;
    const auto request = weave_request(*session, context.query);
    if (!request) co_return request.error();
    const auto permit = context.services.work_classes.wait_for_replay();
    if (!permit) co_return permit.error();
    const auto maps = session->snapshot();
    const Revision newest = maps->revision;
    auto& weaves = context.services.weaves;
    const auto poses = co_await poses_for(*session, *request, *maps);
    const auto weave = weaves.start(session->info(), *request, newest, poses, sessions::ReplayJobs::Listing::kUnlisted);
    if (!weave) co_return weave.error();
    const Revision target = sessions::target_of(*request, newest);
    co_await wait_for(context, **weave, target);
    co_return maps_of(session, *weave, (*weave)->maps_with(target));
}

} // namespace

Result<Maps> find_maps(const Context& context, Waiting waiting) { return chosen(context, kWeave, waiting); }

boost::asio::awaitable<Result<Maps>> find_maps_or_replay(Context& context) {
    if (!has_weave_parameters(context.query)) co_return chosen(context, kWeave);
    if (context.query.find(kWeave)) {
        co_return Error{Errc::kInvalidField,
                        "weave selects maps that have their own settings; remove the other settings"};
    }
    co_return co_await replayed(context);
}

Result<TwoMaps> find_two_maps(const Context& context) {
    if (!context.query.find(kWeave) && !context.query.find(kWith)) {
        return Error{Errc::kInvalidField,
                     "weave=, with= or both are needed; the one that is not given is the session's own map"};
    }
    auto a = chosen(context, kWeave);
    if (!a) return a.error();
    auto b = chosen(context, kWith);
    if (!b) return b.error();
    return TwoMaps{std::move(*a), std::move(*b)};
}

boost::asio::awaitable<Result<>> wait_for_corrections(Context& context) {
    constexpr std::chrono::milliseconds kPause{20};
    const auto session = context.session;
    if (session->snapshot()->moving_scans == 0) co_return Result<>();
    const WorkClass work = context.work;
    co_await context.run_on(WorkClass::kIo);
    boost::asio::steady_timer timer(co_await boost::asio::this_coro::executor);
    const auto end = std::chrono::steady_clock::now() + context.services.replay_timeout;
    std::uint64_t moving = 1;
    while (moving > 0 && std::chrono::steady_clock::now() < end) {
        timer.expires_after(kPause);
        co_await timer.async_wait(kAwaitTuple);
        const auto maps = session->try_snapshot();
        if (maps) moving = maps->moving_scans;
    }
    co_await context.run_on(work);
    if (moving == 0) co_return Result<>();
    co_return Error{Errc::kOverloaded,
                    fmt::format("{} scans are being moved to corrected poses; try again soon", moving)};
}

} // namespace scanloom::http
