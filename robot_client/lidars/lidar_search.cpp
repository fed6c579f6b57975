#include "robot_client/lidars/lidar_search.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <system_error>
#include <utility>

namespace scanloom::robot {

namespace asio = boost::asio;

namespace {

using Found = std::optional<LidarIdentity>;

constexpr std::chrono::milliseconds kPauseAfterStop{30}; // a sensor needs some time until it takes the next request
constexpr std::chrono::milliseconds kConnectWithin{2'000};
constexpr std::size_t kProbedBytesMax = 65'536;

/// Reads for some time, or until the probe identifies a lidar in all bytes so far.
asio::awaitable<Result<Found>> listen(LidarLine& line, const LidarProbe& probe, std::chrono::milliseconds period,
                                      std::vector<std::uint8_t>& bytes) {
    std::array<std::uint8_t, 1024> buffer{};
    const auto until = std::chrono::steady_clock::now() + period;
    for (;;) {
        const auto rest = std::chrono::ceil<std::chrono::milliseconds>(until - std::chrono::steady_clock::now());
        if (rest.count() <= 0 || bytes.size() > kProbedBytesMax) co_return Found{};
        const auto count = co_await read_some(line, buffer, rest);
        if (!count) co_return count.error();
        if (!*count) continue;
        bytes.insert(bytes.end(), buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(**count));
        if (auto found = probe.identify(bytes)) co_return found;
    }
}

asio::awaitable<Result<Found>> attempt(LidarLine& line, const LidarProbe& probe,
                                       std::chrono::milliseconds answer_within) {
    if (auto set = set_baud(line, probe.baud); !set) co_return set.error();
    std::vector<std::uint8_t> bytes;
    for (const auto& request : probe.requests) {
        if (auto sent = co_await write_all(line, request, kConnectWithin); !sent) co_return sent.error();
        const bool is_last = &request == &probe.requests.back();
        auto found = co_await listen(line, probe, is_last ? answer_within : kPauseAfterStop, bytes);
        if (!found || *found) co_return found;
    }
    if (!probe.requests.empty()) co_return Found{};
    co_return co_await listen(line, probe, answer_within, bytes);
}

} // namespace

std::vector<std::string> serial_devices(const std::filesystem::path& dev) {
    namespace fs = std::filesystem;
    std::error_code missing;
    std::vector<std::string> names;
    std::set<fs::path> named; // the devices that have a name by their maker
    for (const auto& entry : fs::directory_iterator(dev / "serial" / "by-id", missing)) {
        names.push_back(entry.path());
        named.insert(fs::weakly_canonical(entry.path(), missing));
    }
    for (const auto& entry : fs::directory_iterator(dev, missing)) {
        const std::string name = entry.path().filename();
        const bool is_serial = name.starts_with("ttyUSB") || name.starts_with("ttyACM");
        if (is_serial && !named.contains(fs::weakly_canonical(entry.path(), missing))) names.push_back(entry.path());
    }
    std::ranges::sort(names);
    return names;
}

asio::awaitable<Result<Found>> identify_lidar(LidarEndpoint endpoint, std::chrono::milliseconds answer_within) {
    const auto& probes = lidar_probes();
    auto line = co_await open_line(endpoint, {probes.front().baud, {}}, kConnectWithin);
    if (!line) co_return line.error();
    for (const auto& probe : probes) {
        auto found = co_await attempt(*line, probe, answer_within);
        if (!found) co_return prefixed(name_of(endpoint) + ": ", found.error());
        if (*found) co_return found;
    }
    co_return Found{};
}

} // namespace scanloom::robot
