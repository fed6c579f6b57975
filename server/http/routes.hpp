#pragma once

#include "common/error/error.hpp"
#include "server/http/response.hpp"
#include "server/http/target.hpp"
#include "server/http/work_classes.hpp"

#include <boost/asio/awaitable.hpp>

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace scanloom::http {

struct Context;

/// The method of a route, and the body that it reads.
enum class Method {
    kGet,      ///< also answers HEAD
    kPost,     ///< JSON, at most ServerConfig::body_bytes_max
    kPostForm, ///< multipart/form-data, at most ServerConfig::import_bytes_max
    kDelete,
};

/// Returns "GET", "POST" or "DELETE".
[[nodiscard]] std::string_view name_of(Method method) noexcept;

/// The permission that an operation requires of a token. A replay job does not change its session: it needs the same
/// permission with POST as with GET.
enum class Access {
    kOpen,    ///< none; some responses contain more if the request has a token
    kServer,  ///< the token is for all sessions
    kOperate, ///< to back up the store or stop the server: the token is for all sessions and may change them
    kList,    ///< to read sessions; only those that the token is for are returned
    kRead,    ///< to read the session in the path
    kGuide,   ///< to assign goals to robots of the session in the path
    kCreate,  ///< to change sessions; the handler checks which
    kChange,  ///< to change the session in the path
};

/// Whether the token must be for the session in the path.
[[nodiscard]] constexpr bool is_about_one_session(Access access) noexcept {
    return access == Access::kRead || access == Access::kGuide || access == Access::kChange;
}

/// The sessions that a handler uses.
enum class Sessions {
    kUnused, ///< none; it answers also before they are recovered from the store
    kListed, ///< their list
    kLoaded, ///< the one in the path, which is loaded from the store first: Context::session
};

/// The parameters of a route that ignores those which the server does not know: the viewer's page reads its own.
inline constexpr std::array<std::string_view, 1> kAnyParameters = {"*"};

/// Computes the response to a request. A handler that waits, or continues on another executor, is a coroutine.
class Handler {
public:
    using Function = Result<Response> (*)(Context&);
    using Coroutine = boost::asio::awaitable<Result<Response>> (*)(Context&);

    constexpr Handler(Function function) : function_(function) {}
    constexpr Handler(Coroutine coroutine) : coroutine_(coroutine) {}

    [[nodiscard]] boost::asio::awaitable<Result<Response>> operator()(Context& context) const;

private:
    Function function_ = nullptr;
    Coroutine coroutine_ = nullptr;
};

/// An operation of the API.
struct Route {
    Method method;
    std::string_view path; ///< a pattern, see match_path()
    std::string_view name; ///< operationId in the OpenAPI description; its texts are in openapi.yaml
    Access access;
    WorkClass work; ///< decides where the handler starts, and how many requests may run
    Sessions sessions;
    std::span<const std::string_view> parameters; ///< of the query; others are refused, unless it is kAnyParameters
    Handler handler;
};

/// Returns whether the operation ignores parameters that it does not know.
[[nodiscard]] constexpr bool takes_any_parameter(const Route& route) noexcept {
    return route.parameters.data() == kAnyParameters.data();
}

/// Returns all operations of this server.
[[nodiscard]] std::span<const Route> routes() noexcept;

/// The route of a request, with the arguments of its path.
struct Match {
    const Route& route;
    Arguments arguments;
};

struct NoSuchPath {};

/// The path exists, but not with this method.
struct MethodNotAllowed {
    std::string allow; ///< for the Allow field: "GET, HEAD, DELETE"
};

/// Finds the route for a method and the decoded segments of a path.
[[nodiscard]] std::variant<Match, NoSuchPath, MethodNotAllowed>
find_route(std::span<const Route> routes, std::string_view method, const std::vector<std::string>& segments);

} // namespace scanloom::http
