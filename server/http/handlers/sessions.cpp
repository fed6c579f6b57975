#include "server/http/handlers/handlers.hpp"

#include "common/json/json_text.hpp"
#include "common/ros_map/description.hpp"
#include "common/scan/limits.hpp"
#include "core/mapping/map_config.hpp"
#include "server/http/handlers/lookup.hpp"
#include "server/http/handlers/parameters.hpp"
#include "server/http/handlers/session_json.hpp"
#include "server/http/json_read.hpp"
#include "server/http/multipart.hpp"
#include "server/http/text.hpp"
#include "server/tiles/ros_map_import.hpp"

#include <boost/json/array.hpp>
#include <fmt/format.h>

#include <cstdint>
#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace scanloom::http {
namespace {

/// Accepts a session's name, or '#' and the number of a session whose record cannot be read.
std::optional<std::string_view> parse_listed_name(std::string_view text) {
    return is_valid_name(text.substr(text.starts_with('#') ? 1 : 0)) ? std::optional(text) : std::nullopt;
}

struct Page {
    std::size_t limit;
    std::string_view after; ///< empty: starts with the first
};

Result<Page> parse_page(const Query& query) {
    const auto limit = parameter(query, "limit", std::size_t{100}, integer_from<std::size_t>(1, 1000),
                                 "a whole number from 1 to 1000 is needed");
    if (!limit) return limit.error();
    const auto after =
        parameter(query, "after", std::string_view(), parse_listed_name, "the name of a session is needed");
    if (!after) return after.error();
    return Page{*limit, *after};
}

/// A session that is served, or the reason why it is not.
using ListedSession = Result<sessions::ListedSession>;

std::map<std::string, ListedSession, std::less<>> sessions_by_name(const sessions::SessionRegistry& sessions,
                                                                   const auth::Token& seen_by) {
    std::map<std::string, ListedSession, std::less<>> listed;
    for (auto& session : sessions.all()) listed.emplace(session.info.name, session);
    for (const auto& [name, reason] : sessions.damaged()) listed.emplace(name, reason);
    std::erase_if(listed, [&](const auto& entry) { return !is_for(seen_by, entry.first); });
    return listed;
}

/// What is known of the store of all sessions.
struct StoreState {
    std::map<std::string, Error> damaged; ///< found since the start, in sessions that are still served
    std::optional<std::string> failure;   ///< why it accepts no changes

    explicit StoreState(const Services& services)
        : damaged(services.check.damaged()), failure(services.log.stats().last_error) {}
};

boost::json::object listed_json(const sessions::ListedSession& listed, const StoreState& store) {
    auto json = to_json(listed, store.failure);
    const auto damage = store.damaged.find(listed.info.name);
    if (damage != store.damaged.end()) json["damage"] = damage->second.message;
    return json;
}

boost::json::object listed_json(const ListedSession& listed, std::string_view name, const StoreState& store) {
    return listed ? listed_json(*listed, store) : damaged_json(name, listed.error());
}

Response created_session(const sessions::Session& session) {
    return created(to_json(session)).set("Location", fmt::format("/api/v1/sessions/{}", session.info().name));
}

} // namespace

Result<Response> list_sessions(Context& context) {
    const auto page = parse_page(context.query);
    if (!page) return page.error();
    const StoreState store(context.services);
    const auto listed = sessions_by_name(context.services.sessions, *context.token);
    boost::json::array shown;
    boost::json::value next = nullptr;
    auto entry = listed.upper_bound(page->after);
    for (; entry != listed.end() && shown.size() < page->limit; ++entry) {
        shown.push_back(listed_json(entry->second, entry->first, store));
        if (shown.size() == page->limit && std::next(entry) != listed.end()) next = boost::json::string(entry->first);
    }
    return ok(boost::json::object{{"sessions", std::move(shown)}, {"next", std::move(next)}});
}

Result<Response> create_session(Context& context) {
    const auto wanted = parse_session_request(context.request.body);
    if (!wanted) return wanted.error();
    if (const auto permitted = check_permission(*context.token, auth::Action::kChange, wanted->name); !permitted)
        return context.services.authorizer.refuse(context.request, permitted.error(), wanted->name);
    const auto session = context.services.sessions.create(
        wanted->name, wanted->options, sessions::creator_of(*context.token), wanted->is_localize_only);
    if (!session) return context.services.authorizer.noted(context, session.error(), wanted->name);
    return created_session(**session);
}

Result<Response> get_session(Context& context) {
    const auto listed = find_listed(context);
    if (!listed) return listed.error();
    return ok(listed_json(*listed, StoreState(context.services)));
}

namespace {

/// Frees what is kept about a session that does not exist any more.
void forget(Context& context, const sessions::SessionInfo& info) {
    context.services.weaves.remove_all(info.id);
    context.services.landmarks.remove(info.id);
    context.services.locator.remove(info.id);
    context.services.tiles.forget(sessions::tag_of(info));
}

} // namespace

Result<Response> delete_session(Context& context) {
    const auto& name = context.arguments["session"];
    const auto info = context.services.sessions.info(name);
    if (auto removed = context.services.sessions.remove(name); !removed) return removed.error();
    if (info) forget(context, *info);
    return no_content();
}

Result<Response> estimate_session(Context& context) {
    const auto body = parse_json_object(context.request.body, {"poses"});
    if (!body) return body.error();
    if (body->contains("poses")) {
        const auto poses = read_text(*body, "poses");
        if (!poses) return poses.error();
        if (*poses != name_of(Poses::kOdometry)) {
            return Error{Errc::kInvalidField,
                         fmt::format("poses is {}; it can only be \"odometry\"", in_quotes(*poses))};
        }
    }
    const auto before = context.services.sessions.estimate(context.arguments["session"]);
    if (!before) return before.error();
    forget(context, *before);
    auto response = get_session(context);
    if (response) response->status = Status::accepted;
    return response;
}

namespace {

/// The contents of the form.
struct Form {
    std::optional<std::string_view> yaml;
    std::optional<std::string_view> image;
    SessionOptions options;
    bool is_localize_only = false;
};

Result<Form> read_form(const Request& request) {
    const auto fields = parse_form(request.content_type, request.body);
    if (!fields) return fields.error();
    Form form;
    for (const auto& [name, content] : *fields) {
        const auto* setting = mapping::find_config_field(name);
        if (name == "yaml") {
            form.yaml = content;
        } else if (name == "image") {
            form.image = content;
        } else if (name == "localize_only" && (content == "true" || content == "false")) {
            form.is_localize_only = content == "true";
        } else if (name == "localize_only") {
            return Error{Errc::kInvalidField, "localize_only is neither true nor false"};
        } else if (setting == nullptr) {
            return Error{Errc::kInvalidField, fmt::format("the field {} is unknown here; possible are yaml, image, "
                                                          "localize_only and the settings of a session",
                                                          in_quotes(name))};
        } else if (auto set = mapping::set_option(form.options, *setting, content); !set) {
            return set.error();
        }
    }
    if (!form.yaml) return Error{Errc::kInvalidField, "yaml is missing; the map's description is needed"};
    if (!form.image) return Error{Errc::kInvalidField, "image is missing; the map's PGM or PNG is needed"};
    return form;
}

} // namespace

Result<Response> import_map(Context& context) {
    auto form = read_form(context.request);
    if (!form) return form.error();
    const auto description = parse_ros_yaml(*form->yaml);
    if (!description) return description.error();
    const auto* pixels = reinterpret_cast<const std::uint8_t*>(form->image->data());
    const auto patches = tiles::read_ros_image(*description, std::span(pixels, form->image->size()));
    if (!patches) return patches.error();

    if (!form->options.cell_size) {
        SessionOptions as_fine_as_the_image;
        as_fine_as_the_image.cell_size = description->resolution;
        if (!mapping::resolve(as_fine_as_the_image)) {
            return Error{Errc::kInvalidField, fmt::format("the map has {:g} metres per pixel, which is no valid cell "
                                                          "size; add the field cell_size, 0.01 to 1.0 metres",
                                                          description->resolution)};
        }
        form->options.cell_size = description->resolution;
    }
    const auto& name = context.arguments["session"];
    const auto session = context.services.sessions.import_map(
        name, form->options, *patches, sessions::creator_of(*context.token), form->is_localize_only);
    if (!session) return context.services.authorizer.noted(context, session.error(), name);
    return created_session(**session);
}

} // namespace scanloom::http
