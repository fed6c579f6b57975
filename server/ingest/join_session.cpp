#include "server/ingest/join_session.hpp"

#include "core/mapping/map_config.hpp"
#include "server/sockets/worker_pool.hpp"

#include <fmt/format.h>

#include <string>
#include <utility>

namespace scanloom::ingest {
namespace asio = boost::asio;
namespace {

using Found = Result<std::shared_ptr<sessions::Session>>;

asio::awaitable<Found> create(const wire::Hello& hello, sessions::SessionRegistry& sessions,
                              const sessions::Creator& maker, asio::any_io_executor blocking_executor) {
    auto created = co_await sockets::compute_on(std::move(blocking_executor),
                                                [&] { return sessions.create(hello.session, *hello.create, maker); });
    if (!created && created.error().code == Errc::kInvalidField) co_return prefixed("hello.create.", created.error());
    co_return created;
}

asio::awaitable<Found> loaded(const std::string& name, sessions::SessionRegistry& sessions) {
    const auto load = [&](auto done) { sessions.load(name, std::move(done)); };
    co_return co_await sockets::resume_with<Found>(load);
}

/// Returns the error for the robot if the session could not be loaded.
Error absence_of(const std::string& name, const sessions::SessionRegistry& sessions, const Error& why) {
    const auto damaged = sessions.damaged();
    const auto damage = damaged.find(name);
    if (damage == damaged.end()) {
        if (why.code != Errc::kNotFound) return why;
        return {
            Errc::kNotFound,
            fmt::format("hello.session is '{}', which does not exist; create it first, or send hello.create", name)};
    }
    if (damage->second.code == Errc::kOverloaded) return damage->second; // it is not damaged
    return {Errc::kConflict,
            fmt::format("hello.session is '{}', whose log is damaged; delete the session first, or choose another name",
                        name)};
}

} // namespace

asio::awaitable<Found> session_for(const wire::Hello& hello, sessions::SessionRegistry& sessions,
                                   const sessions::Creator& maker, asio::any_io_executor blocking_executor) {
    auto session = co_await loaded(hello.session, sessions);
    if (!session && session.error().code == Errc::kNotFound && hello.create) {
        auto created = co_await create(hello, sessions, maker, blocking_executor);
        if (created || created.error().code != Errc::kAlreadyExists) co_return created;
        session = co_await loaded(hello.session, sessions); // another robot created it first
    }
    if (session && sessions.is_shared()) { // another server may have acknowledged more to the robot
        const auto confirmed =
            co_await sockets::compute_on(std::move(blocking_executor), [&] { return sessions.confirm(**session); });
        if (!confirmed) co_return confirmed.error();
    }
    if (!session) co_return absence_of(hello.session, sessions, session.error());
    if (hello.create) {
        if (auto agrees = mapping::check_agreement((*session)->info().config, *hello.create); !agrees) {
            co_return prefixed("hello.create: ", agrees.error());
        }
    }
    co_return session;
}

asio::awaitable<Result<sessions::Joined>> join_session(sessions::Session& session, const wire::Hello& hello,
                                                       std::shared_ptr<sessions::RobotListener> listener) {
    const auto join = [&](auto done) {
        session.join({hello.robot, hello.source, hello.body_radius, hello.poses}, std::move(listener), std::move(done));
    };
    co_return co_await sockets::resume_with<Result<sessions::Joined>>(join);
}

} // namespace scanloom::ingest
