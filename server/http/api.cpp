#include "server/http/api.hpp"

#include "server/http/content_coding.hpp"
#include "server/http/handlers/lookup.hpp"
#include "server/http/handlers/weave_request.hpp"
#include "server/http/json_read.hpp"
#include "server/http/multipart.hpp"
#include "server/http/problem.hpp"
#include "server/http/text.hpp"
#include "server/sockets/worker_pool.hpp"

#include <boost/asio/bind_executor.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace scanloom::http {

namespace asio = boost::asio;

namespace {

using SessionRef = std::shared_ptr<sessions::Session>;

/// Checks that the Content-Type is the one that the method reads.
Result<> check_content_type(Method method, const Request& request) {
    const bool wants_form = method == Method::kPostForm;
    const bool wants_json = method == Method::kPost;
    const bool is_right = wants_form   ? is_form(request.content_type)
                          : wants_json ? is_json(request.content_type)
                                       : true;
    if (is_right) return {};
    return Error{Errc::kInvalidField,
                 fmt::format("the body is {}; send Content-Type: {}", in_quotes(request.content_type),
                             wants_form ? "multipart/form-data" : "application/json")};
}

bool reads(const Route& route, std::string_view parameter) {
    return std::ranges::find(route.parameters, parameter) != route.parameters.end();
}

/// Checks that the operation reads all parameters.
Result<> check_parameters(const Route& route, const Query& query) {
    if (takes_any_parameter(route)) return {};
    auto known = query.check_only(route.parameters);
    if (known || !has_weave_parameters(query) || !reads(route, "weave") || reads(route, "until")) return known;
    return Error{Errc::kInvalidField,
                 fmt::format("{}. For settings and until, POST them to .../weave, and give its id as weave=",
                             known.error().message)};
}

/// Returns the request with the token of its query, for programs that cannot send an Authorization field; nullopt: it
/// has none.
std::optional<Request> request_with_token(const Request& head, const Route& route, const Query& query) {
    const auto token = reads(route, "token") ? query.find("token") : std::nullopt;
    if (!token || !head.authorization.empty()) return std::nullopt;
    Request with_token = head;
    with_token.authorization = fmt::format("Bearer {}", *token);
    return with_token;
}

/// Returns the session, which is loaded from the store if it is not in memory.
asio::awaitable<Result<SessionRef>> load_session(sessions::SessionRegistry& sessions, const std::string& name) {
    if (auto session = sessions.find(name)) co_return session;
    const auto load = [&](auto done) { sessions.load(name, std::move(done)); };
    const auto loaded = co_await sockets::resume_with<Result<SessionRef>>(load);
    if (loaded) co_return loaded;
    co_return damage_of(sessions, name).value_or(loaded.error());
}

} // namespace

asio::awaitable<void> Context::run_on(WorkClass next) {
    if (next == work) co_return;
    work = next;
    if (next == WorkClass::kIo) {
        co_await asio::post(asio::use_awaitable);
    } else {
        co_await asio::post(asio::bind_executor(services.work_classes.executor_of(next), asio::use_awaitable));
    }
}

std::variant<Api::Routed, Response> Api::route(const Request& head) const {
    const auto path = instance_of(head.target);
    auto target = parse_target(head.target);
    if (!target) return problem(target.error(), path);
    auto found = find_route(routes_, head.method, target->segments);
    if (std::holds_alternative<NoSuchPath>(found)) {
        return problem(Error{Errc::kNotFound, "there is nothing at this path; /openapi.json lists what there is"},
                       path);
    }
    if (const auto* refused = std::get_if<MethodNotAllowed>(&found)) {
        return problem(Status::method_not_allowed,
                       fmt::format("{} is not possible here; use one of {}", in_quotes(head.method), refused->allow),
                       path)
            .set("Allow", refused->allow);
    }
    return Routed{std::get<Match>(std::move(found)), std::move(target->query)};
}

std::variant<Api::Admitted, Response> Api::admit(const Request& head, Routed routed) const {
    const auto& [route, arguments] = routed.match;
    const auto path = instance_of(head.target);
    const auto session = is_about_one_session(route.access) ? std::string_view(arguments["session"]) : "";
    const auto with_token = request_with_token(head, route, routed.query);
    auto token = services_.authorizer.admit(with_token ? *with_token : head, route.access, session);
    if (auto* refusal = std::get_if<Response>(&token)) return std::move(*refusal);
    if (auto accepted = check_content_type(route.method, head); !accepted) {
        return problem(Status::unsupported_media_type, accepted.error().message, path);
    }
    WorkClasses::Permit permit;
    if (route.method == Method::kPostForm) {
        auto taken = services_.work_classes.enter(route.work);
        if (!taken) return problem(taken.error(), path);
        permit = std::move(*taken);
    }
    return Admitted{std::move(routed), std::get<auth::TokenRef>(std::move(token)), std::move(permit)};
}

asio::awaitable<Result<std::shared_ptr<const store::NodeInfo>>> Api::owner_of(const Admitted& admitted,
                                                                              const Request& request) const {
    const std::shared_ptr<const store::NodeInfo> this_server;
    const auto& match = admitted.routed.match;
    const bool is_shared = !services_.nodes.secret.empty() && services_.recovered;
    if (!is_shared || request.is_forwarded || !is_about_one_session(match.route.access)) co_return this_server;
    auto& sessions = services_.sessions;
    const std::string name(match.arguments["session"]);
    if (auto known = sessions.owner(name)) co_return known;
    const auto loaded = co_await load_session(sessions, name);
    if (loaded || loaded.error().code != Errc::kNotOwner) co_return this_server;
    if (auto known = sessions.owner(name)) co_return known;
    co_return loaded.error();
}

asio::awaitable<Response> Api::answer(Admitted admitted, const Request& request) const {
    const auto& [match, query] = admitted.routed;
    Context context{services_, request, match.arguments, query, admitted.token};
    std::optional<Response> response;
    try {
        Result<Response> made = co_await call(match.route, context, admitted.permit);
        if (!made) {
            response = problem(made.error(), instance_of(request.target));
            const bool is_misdirected = request.is_forwarded && made.error().code == Errc::kNotOwner;
            if (is_misdirected) response->status = Status::misdirected_request; // the other server tries again
        } else {
            response = for_client(match.route.access, std::move(*made));
            const bool can_encode = context.work != WorkClass::kIo || response->gzip; // compressing takes milliseconds
            if (can_encode) response = encoded_for(request.accept_encoding, std::move(*response));
        }
    } catch (const std::exception& failure) { // costs one response
        spdlog::error("{} {} failed: {}", in_quotes(request.method), in_quotes(request.target), failure.what());
        response = problem(Error{Errc::kInternal, "the server failed to answer; its log says why"},
                           instance_of(request.target));
    }
    co_await context.run_on(WorkClass::kIo);
    co_return std::move(*response);
}

asio::awaitable<Result<Response>> Api::call(const Route& route, Context& context, WorkClasses::Permit& permit) const {
    if (route.sessions != Sessions::kUnused && !services_.recovered) {
        co_return Error{Errc::kOverloaded, "the sessions are still being recovered from the store; try again soon"};
    }
    Result<SessionRef> session = SessionRef();
    if (route.sessions == Sessions::kLoaded) {
        session = co_await load_session(services_.sessions, context.arguments["session"]);
    }
    if (!permit) {
        auto taken = services_.work_classes.enter(route.work);
        if (!taken) co_return taken.error();
        permit = std::move(*taken);
    }
    co_await context.run_on(route.work);
    if (auto known = check_parameters(route, context.query); !known) co_return known.error();
    if (!session) co_return session.error();
    context.session = *std::move(session);
    co_return co_await route.handler(context);
}

/// A response that depends on permissions must not be kept by shared caches, so "public" becomes "private".
Response Api::for_client(Access access, Response response) const {
    if (access == Access::kOpen || services_.authorizer.authenticator().is_open()) return response;
    for (auto& [field, value] : response.fields) {
        constexpr std::string_view kPublic = "public";
        if (field == "Cache-Control" && value.starts_with(kPublic)) value.replace(0, kPublic.size(), "private");
    }
    return response;
}

} // namespace scanloom::http
