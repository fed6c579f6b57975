#include "server/http/handlers/handlers.hpp"

#include "server/http/handlers/lookup.hpp"
#include "server/http/handlers/parameters.hpp"
#include "server/http/json_read.hpp"
#include "server/http/text.hpp"

#include <boost/json/array.hpp>
#include <fmt/format.h>

#include <string>
#include <string_view>
#include <variant>

namespace scanloom::http {
namespace {

constexpr std::string_view kSeq = "seq:";

/// One end of a range.
using Bound = std::variant<double, std::uint64_t>; // a stamp (s) or a sequence number

Error no_bound(std::string_view name, std::string_view what) {
    return {Errc::kInvalidField, fmt::format("{} is {}; a stamp in seconds or a text \"seq:N\" is needed", name, what)};
}

Result<Bound> read_bound(const boost::json::object& body, std::string_view name) {
    const auto* value = body.if_contains(name);
    if (value == nullptr) return no_bound(name, "missing");
    if (value->is_string()) {
        const std::string_view text = value->get_string();
        const auto seq = text.starts_with(kSeq) ? parse_integer<std::uint64_t>(text.substr(kSeq.size())) : std::nullopt;
        return seq ? Result<Bound>(*seq) : no_bound(name, in_quotes(text));
    }
    const auto stamp = read_number(body, name);
    return stamp ? Result<Bound>(**stamp) : no_bound(name, "neither");
}

Result<std::variant<StampRange, SeqRange>> read_range(const boost::json::object& body) {
    const auto from = read_bound(body, "from");
    if (!from) return from.error();
    const auto to = read_bound(body, "to");
    if (!to) return to.error();
    if (from->index() != to->index()) {
        return Error{Errc::kInvalidField, "from and to are of two kinds; give two stamps, or two texts \"seq:N\""};
    }
    if (*from > *to) return Error{Errc::kInvalidField, "from is greater than to; swap them"};
    if (const auto* stamp = std::get_if<double>(&*from)) return {StampRange{*stamp, std::get<double>(*to)}};
    return {SeqRange{std::get<std::uint64_t>(*from), std::get<std::uint64_t>(*to)}};
}

boost::json::object exclusion_json(const Exclusion& exclusion, std::string_view robot) {
    const auto& [id, index, scans] = exclusion.excluded;
    boost::json::object json{{"id", id}, {"robot", robot}};
    if (const auto* stamps = std::get_if<StampRange>(&scans)) {
        json["from"] = stamps->from;
        json["to"] = stamps->to;
    } else {
        const auto& seqs = std::get<SeqRange>(scans);
        json["from"] = fmt::format("{}{}", kSeq, seqs.from);
        json["to"] = fmt::format("{}{}", kSeq, seqs.to);
    }
    json["revision"] = exclusion.since;
    return json;
}

/// Returns the session's data without its maps.
Result<std::shared_ptr<const mapping::Snapshot>> find_facts(const Context& context) {
    const auto listed = find_listed(context);
    if (!listed) return listed.error();
    return listed->session ? listed->session->snapshot() : listed->summary.facts;
}

} // namespace

Result<Response> exclude_scans(Context& context) {
    const auto body = parse_json_object(context.request.body, {"robot", "from", "to"});
    if (!body) return body.error();
    const auto robot = read_text(*body, "robot");
    if (!robot) return robot.error();
    const auto range = read_range(*body);
    if (!range) return range.error();
    const auto facts = find_facts(context);
    if (!facts) return facts.error();
    const auto index = robot_named(**facts, *robot);
    if (!index) return index.error();
    const auto exclusion = context.services.sessions.exclude(context.arguments["session"], *index, *range);
    if (!exclusion) return exclusion.error();
    return created(exclusion_json(*exclusion, *robot));
}

Result<Response> list_exclusions(Context& context) {
    const auto facts = find_facts(context);
    if (!facts) return facts.error();
    boost::json::array exclusions;
    for (const auto& one : (*facts)->exclusions->all()) {
        if (one.lifted == 0) exclusions.push_back(exclusion_json(one, (*facts)->robots[one.excluded.robot].name));
    }
    return ok(boost::json::object{{"exclusions", std::move(exclusions)}});
}

Result<Response> lift_exclusion(Context& context) {
    const auto& text = context.arguments["exclusion"];
    const auto id = parse_integer<std::uint64_t>(text);
    if (!id)
        return Error{Errc::kNotFound, fmt::format("there is no exclusion {}; ids are whole numbers", in_quotes(text))};
    if (auto lifted = context.services.sessions.lift_exclusion(context.arguments["session"], *id); !lifted)
        return lifted.error();
    return no_content();
}

} // namespace scanloom::http
