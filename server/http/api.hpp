#pragma once

#include "server/auth/token.hpp"
#include "server/http/context.hpp"
#include "server/http/request.hpp"
#include "server/http/response.hpp"
#include "server/http/routes.hpp"
#include "server/http/target.hpp"
#include "server/http/work_classes.hpp"
#include "server/store/shared_sessions.hpp"

#include <boost/asio/awaitable.hpp>

#include <memory>
#include <span>
#include <variant>

namespace scanloom::http {

/// Finds the route of a request, checks its permission and has its handler compute the response.
///
/// A failure becomes a response, too, with application/problem+json.
/// Bounds: the limits of WorkClasses; large responses take a permit, such as map images of up to 64 MB; cached tiles
///     take at most Services::tile_bytes_max.
/// Threads: any thread.
class Api {
public:
    /// @param services  must outlive this object, as must `routes`
    explicit Api(Services& services, std::span<const Route> routes = http::routes())
        : services_(services), routes_(routes) {}

    /// A request up to its permission.
    struct Routed {
        Match match;
        Query query;
    };

    /// A request whose header passed all checks.
    struct Admitted {
        Routed routed;
        auth::TokenRef token;
        WorkClasses::Permit permit; ///< of its work; null: not taken yet, or there is no limit
    };

    /// Finds the route.
    /// @param head  the request line and the fields; the body may be missing
    /// @return the route, or the refusal
    [[nodiscard]] std::variant<Routed, Response> route(const Request& head) const;

    /// Checks the permission and the Content-Type. For a large body, also takes a permit of its work.
    [[nodiscard]] std::variant<Admitted, Response> admit(const Request& head, Routed routed) const;

    /// Finds out which server has the session of a request. If none has it, this one takes it.
    /// @param request  not passed on by another server, which would go round in circles
    /// @return the server to pass the request on to; null: this one answers
    /// Errors: kNotOwner: the server that has it seems to be dead, and this one cannot take it yet; try again soon.
    /// Threads: starts and ends on the executor of the coroutine.
    [[nodiscard]] boost::asio::awaitable<Result<std::shared_ptr<const store::NodeInfo>>>
    owner_of(const Admitted& admitted, const Request& request) const;

    /// Computes the response. The session that the route needs is loaded first; no thread waits for that.
    /// Threads: starts and ends on the executor of the coroutine.
    [[nodiscard]] boost::asio::awaitable<Response> answer(Admitted admitted, const Request& request) const;

    [[nodiscard]] const Services& services() const noexcept { return services_; }

private:
    [[nodiscard]] boost::asio::awaitable<Result<Response>> call(const Route& route, Context& context,
                                                                WorkClasses::Permit& permit) const;
    [[nodiscard]] Response for_client(Access access, Response response) const;

    Services& services_;
    std::span<const Route> routes_;
};

} // namespace scanloom::http
