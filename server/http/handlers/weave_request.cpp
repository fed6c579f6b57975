#include "server/http/handlers/weave_request.hpp"

#include "common/json/json_text.hpp"
#include "core/mapping/map_config.hpp"
#include "server/http/handlers/session_json.hpp"
#include "server/http/json_read.hpp"
#include "server/http/text.hpp"
#include "server/sockets/worker_pool.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace scanloom::http {
namespace {

constexpr std::string_view kUntil = "until";
constexpr std::string_view kPoses = "poses";

/// Converts "2000-12-05T22:27:37.5Z" to seconds since 1970.
std::optional<double> parse_rfc3339(std::string_view text) {
    constexpr std::string_view kPattern = "0000-00-00T00:00:00";
    if (text.size() < kPattern.size() + 1 || text.back() != 'Z') return std::nullopt;
    for (std::size_t n = 0; n < kPattern.size(); ++n) {
        const bool is_digit = text[n] >= '0' && text[n] <= '9';
        if (kPattern[n] == '0' ? !is_digit : text[n] != kPattern[n]) return std::nullopt;
    }
    const auto number = [&](std::size_t begin, std::size_t count) {
        return *parse_integer<int>(text.substr(begin, count));
    };
    const std::chrono::year_month_day day(std::chrono::year(number(0, 4)),
                                          std::chrono::month(static_cast<unsigned>(number(5, 2))),
                                          std::chrono::day(static_cast<unsigned>(number(8, 2))));
    const int hours = number(11, 2);
    const int minutes = number(14, 2);
    if (!day.ok() || hours > 23 || minutes > 59 || number(17, 2) > 60) return std::nullopt;
    const auto fraction = text.substr(kPattern.size(), text.size() - kPattern.size() - 1);
    const bool is_fraction = fraction.size() > 1 && fraction.front() == '.' &&
                             fraction.find_first_not_of("0123456789", 1) == std::string_view::npos;
    if (!fraction.empty() && !is_fraction) return std::nullopt;
    const auto seconds = parse_real(text.substr(17, 2 + fraction.size()));
    if (!seconds) return std::nullopt;
    const double days = static_cast<double>(std::chrono::sys_days(day).time_since_epoch().count());
    return days * 86400.0 + hours * 3600.0 + minutes * 60.0 + *seconds;
}

Error wrong_until(std::string_view shown) {
    return {Errc::kInvalidField, fmt::format("until is {}; a revision (912), a stamp in seconds (976052857.5s) or a "
                                             "time (2000-12-05T22:27:37Z) is needed",
                                             shown)};
}

/// @param newest  the session's revision
Result<sessions::ReplayEnd> parse_until(std::string_view text, Revision newest) {
    if (const auto revision = parse_integer<Revision>(text)) {
        if (*revision <= newest) return sessions::ReplayEnd{*revision, std::nullopt};
        return Error{Errc::kConflict,
                     fmt::format("until is {}, but the session is at revision {}; ask again when it is there",
                                 *revision, newest)};
    }
    const auto stamp = text.ends_with('s') ? parse_real(text.substr(0, text.size() - 1)) : parse_rfc3339(text);
    if (stamp) return sessions::ReplayEnd{std::nullopt, *stamp};
    if (text.find(' ') == std::string_view::npos) return wrong_until(in_quotes(text));
    return wrong_until(in_quotes(text) + " (a + in an address is a space, and %2B a +)");
}

/// @param poses  as requested; nullopt: not
Result<sessions::ReplayPoses> parse_poses(std::optional<std::string_view> poses) {
    if (!poses || *poses == name_of(sessions::ReplayPoses::kThen)) return sessions::ReplayPoses::kThen;
    if (*poses == name_of(sessions::ReplayPoses::kNow)) return sessions::ReplayPoses::kNow;
    return Error{Errc::kInvalidField, fmt::format("poses is {}; then and now are possible", in_quotes(*poses))};
}

Result<sessions::ReplayRequest> request_of(const sessions::Session& session, const SessionOptions& options,
                                           std::optional<std::string_view> until,
                                           std::optional<std::string_view> wanted_poses) {
    const auto config = mapping::resolve(options);
    if (!config) return config.error();
    const auto poses = parse_poses(wanted_poses);
    if (!poses) return poses.error();
    if (!until) return sessions::ReplayRequest{*config, {}};
    const auto maps = session.snapshot();
    const auto end = parse_until(*until, maps->revision);
    if (!end) return end.error();
    return sessions::ReplayRequest{*config, *end,
                                   mapping::has_estimated_poses(*maps) ? *poses : sessions::ReplayPoses::kNow};
}

} // namespace

std::span<const std::string_view> weave_parameters() noexcept {
    static const auto names = [] {
        std::vector<std::string_view> all = {kUntil, kPoses};
        for (const auto& field : mapping::config_fields()) all.emplace_back(field.name);
        return all;
    }();
    return names;
}

bool has_weave_parameters(const Query& query) {
    return std::ranges::any_of(weave_parameters(), [&](std::string_view name) { return query.find(name).has_value(); });
}

Result<sessions::ReplayRequest> weave_request(const sessions::Session& session, const Query& query) {
    auto options = mapping::options_of(session.info().config);
    for (const auto& field : mapping::config_fields()) {
        const auto text = query.find(field.name);
        if (!text) continue;
        if (auto set = mapping::set_option(options, field, *text); !set) return set.error();
    }
    return request_of(session, options, query.find(kUntil), query.find(kPoses));
}

Result<sessions::ReplayRequest> weave_request(const sessions::Session& session, const boost::json::object& body) {
    auto options = mapping::options_of(session.info().config);
    if (auto read = read_options(body, options); !read) return read.error();
    std::optional<std::string> poses;
    if (body.contains(kPoses)) {
        auto text = read_text(body, kPoses);
        if (!text) return text.error();
        poses = std::move(*text);
    }
    const auto* until = body.if_contains(kUntil);
    if (until == nullptr) return request_of(session, options, std::nullopt, poses);
    if (until->is_string()) return request_of(session, options, std::string_view(until->get_string()), poses);
    boost::system::error_code not_whole;
    const auto revision = until->to_number<Revision>(not_whole);
    if (!not_whole) return request_of(session, options, std::to_string(revision), poses);
    const auto in_words = in_quotes(json_text(*until));
    return wrong_until(std::string_view(in_words).substr(1, in_words.size() - 2));
}

std::string_view name_of(sessions::ReplayPoses poses) noexcept {
    return poses == sessions::ReplayPoses::kThen ? "then" : "now";
}

boost::asio::awaitable<mapping::ScanPoses> poses_for(sessions::Session& session, const sessions::ReplayRequest& request,
                                                     const mapping::Snapshot& maps) {
    if (request.poses == sessions::ReplayPoses::kNow) co_return maps.scan_poses;
    using History = std::shared_ptr<const localization::PoseHistory>;
    const auto history = co_await sockets::resume_with<History>([&](auto done) {
        session.read_poses([done](const localization::SessionPoses& poses) {
            done(std::make_shared<const localization::PoseHistory>(poses.history()));
        });
    });
    auto poses = request.end.stamp ? history->before(*request.end.stamp, *maps.exclusions)
                                   : history->at(request.end.revision.value());
    poses.set_exclusions(maps.scan_poses.version().exclusions);
    co_return poses;
}

} // namespace scanloom::http
