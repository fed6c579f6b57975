#include "server/foxglove/session_feed.hpp"
#include "tests/fuzz/check.hpp"

#include <algorithm>
#include <memory>
#include <string_view>

/// Input: messages of a viewer, one a line; one that begins with a NUL is binary.
SCANLOOM_FUZZER(foxglove_request)(const std::uint8_t* data, std::size_t size) {
    using namespace scanloom;
    foxglove::SessionFeed feed("lab", "1-1");
    mapping::Snapshot maps;
    maps.robots.emplace_back().name = "r1";
    foxglove::SessionView view;
    view.maps = std::make_shared<const mapping::Snapshot>(std::move(maps));
    fuzz::check(feed.next(view, {}).size() == 2, "a viewer gets a greeting and the topics");
    for (std::string_view input(reinterpret_cast<const char*>(data), size); !input.empty();) {
        const std::string_view line = input.substr(0, input.find('\n'));
        input.remove_prefix(std::min(line.size() + 1, input.size()));
        feed.receive(line, !line.starts_with('\0'));
    }
    const auto messages = feed.next(view, {});
    const auto is_data = [](const foxglove::Outgoing& message) { return !message.is_text; };
    fuzz::check(std::ranges::count_if(messages, is_data) <= 10, "each topic has at most one message");
    fuzz::check(feed.next(view, {}).empty(), "nothing has changed since");
    return 0;
}
