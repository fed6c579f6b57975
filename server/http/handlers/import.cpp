#include "server/http/handlers/import.hpp"

#include "common/ros_map/description.hpp"
#include "server/http/handlers/session_json.hpp"
#include "server/http/in_quotes.hpp"
#include "server/http/multipart.hpp"
#include "server/mapping/map_config.hpp"
#include "server/tiles/ros_map_import.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace scanloom::http {
namespace {

/// The contents of the form.
struct Form {
    std::optional<std::string_view> yaml;
    std::optional<std::string_view> image;
    SessionOptions options;
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
        } else if (setting == nullptr) {
            return Error{Errc::kInvalidField,
                         fmt::format("the field {} is unknown here; possible are yaml, image and the "
                                     "settings of a session",
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

Result<Response> import_map(session::SessionRegistry& sessions, const Doorman& doorman, const Call& call) {
    if (auto known = call.query.check_only({}); !known) return known.error();
    auto form = read_form(call.request);
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
            return Error{Errc::kInvalidField,
                         fmt::format("the map has {:g} metres a pixel, of which no session can have "
                                     "cells; add the field cell_size, 0.01 to 1.0 metres",
                                     description->resolution)};
        }
        form->options.cell_size = description->resolution;
    }
    const auto& name = call.arguments["session"];
    const auto session = sessions.import_map(name, form->options, *patches, session::maker_of(*call.token));
    if (!session) return doorman.noted(call, session.error(), name);
    auto response = ok(to_json(**session)).set("Location", fmt::format("/api/v1/sessions/{}", (*session)->info().name));
    response.status = Status::created;
    return response;
}

} // namespace scanloom::http
