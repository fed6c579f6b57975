#include "server/http/handlers/handlers.hpp"

#include "server/http/handlers/lookup.hpp"
#include "server/http/handlers/session_json.hpp"
#include "server/http/handlers/weave_request.hpp"
#include "server/http/json_read.hpp"

#include <boost/json/array.hpp>
#include <fmt/format.h>

#include <string_view>

namespace scanloom::http {
namespace {

using State = sessions::ReplayJob::State;

std::string_view word_for(State state) {
    switch (state) {
    case State::kWaiting: return "waiting";
    case State::kRunning: return "weaving";
    case State::kDone: return "done";
    case State::kFailed: return "failed";
    case State::kCancelled: return "cancelled";
    }
    return "";
}

boost::json::object shown(const sessions::ReplayJob& weave) {
    const auto progress = weave.progress();
    const auto maps = weave.maps();
    const auto& stamp = weave.request().end.stamp;
    boost::json::object until{{"revision", progress.target}, {"stamp", nullptr}};
    if (stamp) until["stamp"] = *stamp;
    boost::json::object json{{"id", weave.id()},
                             {"state", word_for(progress.state)},
                             {"revision", nullptr},
                             {"woven", progress.applied},
                             {"until", std::move(until)},
                             {"follows", progress.follows},
                             {"poses", name_of(weave.request().poses)},
                             {"exclusions", maps ? maps->exclusions->revision() : 0},
                             {"config", to_json(weave.request().config)}};
    if (progress.revision) json["revision"] = *progress.revision;
    if (progress.error) json["reason"] = progress.error->message;
    return json;
}

Result<std::shared_ptr<sessions::ReplayJob>> weave_in_path(const Context& context) {
    return find_weave(context.services.weaves, *context.session, context.arguments["weave"]);
}

} // namespace

boost::asio::awaitable<Result<Response>> start_weave(Context& context) {
    const auto& session = context.session;
    const auto body = parse_json_object(context.request.body, weave_parameters());
    if (!body) co_return body.error();
    const auto request = weave_request(*session, *body);
    if (!request) co_return request.error();
    const auto maps = session->snapshot();
    const auto poses = co_await poses_for(*session, *request, *maps);
    const auto weave = context.services.weaves.start(session->info(), *request, maps->revision, poses);
    if (!weave) co_return weave.error();
    auto response =
        ok(shown(**weave))
            .set("Location", fmt::format("/api/v1/sessions/{}/weave/{}", session->info().name, (*weave)->id()));
    if ((*weave)->progress().state != State::kDone) response.status = Status::accepted;
    co_return response;
}

Result<Response> list_weaves(Context& context) {
    const auto& session = context.session;
    boost::json::array weaves;
    for (const auto& weave : context.services.weaves.list(session->info().id)) weaves.push_back(shown(*weave));
    return ok(boost::json::object{{"weaves", std::move(weaves)}});
}

Result<Response> get_weave(Context& context) {
    const auto weave = weave_in_path(context);
    if (!weave) return weave.error();
    return ok(shown(**weave));
}

Result<Response> delete_weave(Context& context) {
    const auto weave = weave_in_path(context);
    if (!weave) return weave.error();
    context.services.weaves.remove(context.session->info().id, (*weave)->id());
    return no_content();
}

} // namespace scanloom::http
