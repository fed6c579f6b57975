#pragma once

#include "common/error/error.hpp"
#include "common/wire/messages.hpp"
#include "server/session/session.hpp"
#include "server/session/session_registry.hpp"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>

#include <memory>

/// From a hello to the session it names.
namespace scanloom::ingest {

/// The session that the hello names, made when there is none and the hello says how.
/// Making waits for the disk, on `may_wait`; the session is then the maker's.
/// Errors  kNotFound; kConflict: it has other settings than hello.create, or is damaged; kOverloaded: it is not loaded
///         for want of memory; those of SessionRegistry::create() but kAlreadyExists.
[[nodiscard]] boost::asio::awaitable<Result<std::shared_ptr<session::Session>>>
session_for(const wire::Hello& hello, session::SessionRegistry& sessions, const session::Maker& maker,
            boost::asio::any_io_executor may_wait);

/// Session::join() for a coroutine, which goes on where it was.
[[nodiscard]] boost::asio::awaitable<Result<session::Joined>> join(session::Session& session, const wire::Hello& hello,
                                                                   std::shared_ptr<session::RobotListener> listener);

} // namespace scanloom::ingest
