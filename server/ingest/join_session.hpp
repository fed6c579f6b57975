#pragma once

#include "common/error/error.hpp"
#include "common/wire/messages.hpp"
#include "server/sessions/session.hpp"
#include "server/sessions/session_registry.hpp"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>

#include <memory>

/// Finds, creates and joins the session that a hello names.
namespace scanloom::ingest {

/// Returns the session that the hello names. Creates it if it does not exist and the hello has `create`.
/// @param maker              counts as the creator of a new session
/// @param blocking_executor  runs the creation, which waits for the disk
/// Errors: kNotFound if the session does not exist and the hello has no `create`; kConflict if its settings differ from
///         hello.create, or its log is damaged; kOverloaded if there is not enough memory to load it; those of
///         SessionRegistry::create() except kAlreadyExists.
[[nodiscard]] boost::asio::awaitable<Result<std::shared_ptr<sessions::Session>>>
session_for(const wire::Hello& hello, sessions::SessionRegistry& sessions, const sessions::Creator& maker,
            boost::asio::any_io_executor blocking_executor);

/// Calls Session::join(), and resumes with its result on the coroutine's own executor.
[[nodiscard]] boost::asio::awaitable<Result<sessions::Joined>>
join_session(sessions::Session& session, const wire::Hello& hello, std::shared_ptr<sessions::RobotListener> listener);

} // namespace scanloom::ingest
