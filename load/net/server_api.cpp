#include "load/net/server_api.hpp"

#include "load/core/figure_text.hpp"

#include <boost/json/parse.hpp>
#include <boost/json/serialize.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace scanloom::load {

namespace asio = boost::asio;
namespace json = boost::json;

namespace {

constexpr std::size_t kPageMax = 1000;
constexpr unsigned kNoContent = 204;
constexpr unsigned kNotFound = 404;

std::string path_of(const std::string& session) { return "/api/v1/sessions/" + session; }

/// Returns what `read` makes of a JSON answer; throws a boost::json exception if the answer has another form.
template <class Read>
auto read_json(const Result<net::HttpAnswer>& answer, const std::string& target, Read read)
    -> Result<decltype(read(json::value()))> {
    if (!answer) return answer.error();
    if (answer->status != net::kOk) return refusal(*answer, target);
    try {
        return read(json::parse(answer->body));
    } catch (const boost::system::system_error& unreadable) {
        return Error{Errc::kMalformed,
                     fmt::format("{}: the answer cannot be parsed: {}", target, unreadable.code().message())};
    } catch (const std::exception& unreadable) {
        return Error{Errc::kMalformed, fmt::format("{}: the answer cannot be parsed: {}", target, unreadable.what())};
    }
}

FoundSession read_session(const json::value& value) {
    FoundSession found{
        value.at("scans").to_number<std::uint64_t>(), value.at("revision").to_number<std::uint64_t>(), {}, 0};
    for (const auto& robot : value.at("robots").as_array()) {
        const auto& localization = robot.at("localization");
        const auto placed = robot.at("scans").to_number<std::uint64_t>();
        const auto unplaced = localization.at("unplaced").to_number<std::uint64_t>();
        found.robots.push_back({std::string(robot.at("name").as_string()), placed + unplaced,
                                robot.at("last_seq").to_number<std::uint64_t>()});
        found.scans += unplaced;
        found.corrections = std::max(found.corrections, localization.at("corrections").to_number<std::uint64_t>());
    }
    return found;
}

std::vector<std::string> read_names(const json::value& value) {
    std::vector<std::string> names;
    for (const auto& session : value.at("sessions").as_array()) names.emplace_back(session.at("name").as_string());
    return names;
}

std::vector<TilePlace> read_tile_list(const json::value& value) {
    std::vector<TilePlace> tiles;
    for (const auto& tile : value.at("tiles").as_array()) {
        tiles.push_back({tile.at("x").to_number<std::uint32_t>(), tile.at("y").to_number<std::uint32_t>()});
    }
    return tiles;
}

} // namespace

asio::awaitable<Result<std::vector<std::string>>> sessions_of(net::HttpConnection& http, std::string prefix) {
    std::vector<std::string> names;
    std::string after = prefix; // sessions are listed by name
    for (;;) {
        const auto target = fmt::format("/api/v1/sessions?limit={}&after={}", kPageMax, after);
        const auto answer = co_await http.get(target);
        const auto page = read_json(answer, target, read_names);
        if (!page) co_return page.error();
        for (const auto& name : *page) {
            if (!name.starts_with(prefix)) co_return names;
            names.push_back(name);
        }
        if (page->size() < kPageMax) co_return names;
        if (page->back() <= after) {
            co_return Error{
                Errc::kMalformed,
                fmt::format("{}: the answer lists sessions before the requested one; is this a Scanloom server?",
                            target)};
        }
        after = page->back();
    }
}

asio::awaitable<Result<FoundSession>> find_session(net::HttpConnection& http, std::string session) {
    const auto target = path_of(session);
    const auto answer = co_await http.get(target);
    co_return read_json(answer, target, read_session);
}

asio::awaitable<Result<std::string>> digest_of(net::HttpConnection& http, std::string session) {
    const auto target = path_of(session) + "/digest";
    const auto answer = co_await http.get(target);
    co_return read_json(answer, target, [](const json::value& value) { return json::serialize(value.at("layers")); });
}

asio::awaitable<Result<>> delete_session(net::HttpConnection& http, std::string session) {
    const auto target = path_of(session);
    const auto answer = co_await http.ask(boost::beast::http::verb::delete_, target);
    if (!answer) co_return answer.error();
    if (answer->status != net::kOk && answer->status != kNoContent && answer->status != kNotFound)
        co_return refusal(*answer, target);
    co_return Result<>();
}

asio::awaitable<Result<ServerUse>> server_use(net::HttpConnection& http) {
    const std::string target = "/metrics";
    const auto answer = co_await http.get(target);
    if (!answer) co_return answer.error();
    if (answer->status != net::kOk) co_return refusal(*answer, target);
    const ProcessUse so_far{metric(answer->body, "process_cpu_seconds_total"),
                            metric(answer->body, "process_resident_memory_bytes")};
    co_return ServerUse{so_far, metric(answer->body, "process_start_time_seconds")};
}

asio::awaitable<Result<std::vector<TilePlace>>> tiles_of(net::HttpConnection& http, std::string session,
                                                         std::string layer) {
    const auto target = fmt::format("{}/changes?layer={}&since=0", path_of(session), layer);
    const auto answer = co_await http.get(target);
    co_return read_json(answer, target, read_tile_list);
}

Error refusal(const net::HttpAnswer& answer, const std::string& target) {
    return {Errc::kInternal,
            harmless(fmt::format("{} was answered with {}: {}", target, answer.status, answer.body.substr(0, 300)))};
}

double metric(std::string_view text, std::string_view name) {
    while (!text.empty()) {
        const auto line = text.substr(0, text.find('\n'));
        text.remove_prefix(std::min(line.size() + 1, text.size()));
        if (!line.starts_with(name) || line.size() <= name.size() || line[name.size()] != ' ') continue;
        const auto number = line.substr(name.size() + 1);
        double value = 0.0;
        std::from_chars(number.data(), number.data() + number.size(), value);
        return value;
    }
    return 0.0;
}

} // namespace scanloom::load
