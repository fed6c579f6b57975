#pragma once

#include "tests/support/lidar_emulators.hpp"

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::fuzz {

/// Returns inputs for check_lidar(), by name: what an emulated sensor answers to these requests, followed by some
/// turns.
inline std::map<std::string, std::string> lidar_seeds(testing_support::LidarEmulator& emulator,
                                                      const std::vector<std::string>& requests, char model_flag) {
    using Bytes = std::vector<std::uint8_t>;
    Bytes bytes;
    const auto append = [&](const Bytes& more) { bytes.insert(bytes.end(), more.begin(), more.end()); };
    for (const auto& request : requests) append(emulator.receive(Bytes(request.begin(), request.end())));
    for (int turn = 0; turn < 3 && emulator.is_measuring(); ++turn) append(emulator.next_turn());

    const auto seed = [&](unsigned flags, std::string_view sizes) {
        const char first = static_cast<char>(flags | sizes.size() | static_cast<unsigned char>(model_flag));
        return std::string(1, first).append(sizes).append(bytes.begin(), bytes.end());
    };
    std::map<std::string, std::string> seeds{{"turns", seed(0, "")},
                                             {"turns_smoothed_and_split", seed(128, "\x01\x2e\x07")}};
    for (std::size_t at = 150; at < bytes.size(); at += 700) bytes[at] ^= 0x20;
    bytes.erase(bytes.begin() + static_cast<std::ptrdiff_t>(bytes.size() / 2),
                bytes.begin() + static_cast<std::ptrdiff_t>(bytes.size() / 2 + 20));
    seeds.emplace("damaged_turns", seed(0, ""));
    return seeds;
}

} // namespace scanloom::fuzz
