#include "robot_client/lidars/hokuyo_scip.hpp"

#include "common/scan/limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace scanloom::robot {
namespace {

constexpr char kScipOrigin = '0'; // of 6 bits

/// Returns the next line and removes it with its end from `text`.
std::string_view take_line(std::string_view& text) {
    const auto end = std::min(text.find('\n'), text.size());
    const auto line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    return line;
}

Error damaged_reply(std::string_view what) {
    return Error{Errc::kMalformed, fmt::format("the reply of the Hokuyo is damaged: {}", what)};
}

} // namespace

char scip_sum(std::string_view text) noexcept {
    unsigned sum = 0;
    for (const char character : text) sum += static_cast<unsigned char>(character);
    return static_cast<char>((sum & 0x3FU) + kScipOrigin);
}

bool has_scip_sum(std::string_view line) noexcept {
    return !line.empty() && scip_sum(line.substr(0, line.size() - 1)) == line.back();
}

std::optional<std::uint32_t> decode_scip(std::string_view characters) noexcept {
    std::uint32_t number = 0;
    for (const char character : characters) {
        const int bits = character - kScipOrigin;
        if (bits < 0 || bits > 0x3F) return std::nullopt;
        number = number << 6 | static_cast<std::uint32_t>(bits);
    }
    return number;
}

void ScipReader::feed(std::span<const std::uint8_t> bytes) { bytes_.append(bytes.begin(), bytes.end()); }

std::optional<ScipReply> ScipReader::next() {
    bytes_.erase(0, bytes_.find_first_not_of('\n')); // empty lines before a reply
    const auto end = bytes_.find("\n\n");
    if (end == std::string::npos) {
        if (bytes_.size() > kReplyBytesMax) bytes_.clear();
        return std::nullopt;
    }
    std::string_view text = std::string_view(bytes_).substr(0, end);
    ScipReply reply;
    reply.command = take_line(text);
    std::string_view status = take_line(text);
    reply.is_damaged = status.size() == 3 && !has_scip_sum(status);
    reply.status = status.substr(0, 2); // of SCIP 1: one character and no check character
    std::ranges::replace_if(
        reply.status, [](char c) { return c < ' ' || c > '~'; }, '?');
    while (!text.empty()) reply.lines.emplace_back(take_line(text));
    bytes_.erase(0, end + 2);
    return reply;
}

std::string scip_value(const ScipReply& reply, std::string_view name) {
    for (const std::string_view line : reply.lines) {
        const auto end = line.rfind(';');
        if (end == std::string_view::npos || end + 2 != line.size()) continue;
        const auto text = line.substr(0, end);
        if (!text.starts_with(name) || text.substr(name.size(), 1) != ":" || scip_sum(text) != line.back()) continue;
        std::string value(text.substr(name.size() + 1));
        std::ranges::replace_if(
            value, [](char c) { return c < ' ' || c > '~'; }, '?'); // for terminals
        return value;
    }
    return {};
}

Result<HokuyoParameters> read_hokuyo_parameters(const ScipReply& reply) {
    HokuyoParameters found;
    struct Row {
        std::string_view name;
        std::int32_t* value;
        std::int32_t min;
        std::int32_t max;
    };
    constexpr auto kMillimetresMax = static_cast<std::int32_t>(kRangeMax * 1000.0);
    constexpr std::int32_t kStepMax = 9'999; // commands have four digits
    const Row rows[] = {
        {"DMIN", &found.range_min, 0, kMillimetresMax - 1},
        {"DMAX", &found.range_max, 1, kMillimetresMax},
        {"ARES", &found.steps_per_turn, 1, 1'000'000},
        {"AMIN", &found.first_step, 0, kStepMax},
        {"AMAX", &found.last_step, 0, kStepMax},
        {"AFRT", &found.front_step, 0, kStepMax},
        {"SCAN", &found.rpm, 60, 100'000},
    };
    for (const auto& [name, value, min, max] : rows) {
        const std::string text = scip_value(reply, name);
        const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), *value);
        if (failed != std::errc{} || end != text.data() + text.size() || *value < min || *value > max) {
            return damaged_reply(fmt::format("its {} is '{}', not a number from {} to {}", name, text, min, max));
        }
    }
    found.model = scip_value(reply, "MODL");
    if (found.range_min >= found.range_max) return damaged_reply("its DMIN is not less than its DMAX");
    if (found.first_step > found.last_step) return damaged_reply("its AMIN is more than its AMAX");
    if (found.beams() > kBeamsMax || found.last_step - found.first_step >= found.steps_per_turn) {
        return damaged_reply(fmt::format("it has {} steps, more than a turn or than {}", found.beams(), kBeamsMax));
    }
    return found;
}

Result<HokuyoScan> read_hokuyo_scan(const ScipReply& reply, std::size_t beams) {
    constexpr std::size_t kTimeCharacters = 4;
    constexpr std::size_t kCharacters = 3; // of a distance
    if (reply.lines.empty()) return damaged_reply("it has no data");
    std::string data;
    for (const auto& line : reply.lines) {
        if (!has_scip_sum(line)) return damaged_reply("a check character is wrong");
        data.append(line, 0, line.size() - 1);
    }
    if (data.size() != kTimeCharacters + beams * kCharacters || reply.lines.front().size() != kTimeCharacters + 1) {
        return damaged_reply(fmt::format("it has {} characters of data", data.size()));
    }
    HokuyoScan scan;
    const std::string_view text = data;
    const auto milliseconds = decode_scip(text.substr(0, kTimeCharacters));
    if (!milliseconds) return damaged_reply("its time is no number");
    scan.milliseconds = *milliseconds;
    scan.distances.reserve(beams);
    for (std::size_t at = kTimeCharacters; at < text.size(); at += kCharacters) {
        const auto distance = decode_scip(text.substr(at, kCharacters));
        if (!distance) return damaged_reply("a distance is no number");
        scan.distances.push_back(*distance);
    }
    return scan;
}

} // namespace scanloom::robot
