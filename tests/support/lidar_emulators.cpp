#include "tests/support/lidar_emulators.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>

namespace scanloom::testing_support {
namespace {

using Bytes = LidarEmulator::Bytes;

void append(Bytes& bytes, std::initializer_list<unsigned> more) {
    for (const unsigned byte : more) bytes.push_back(static_cast<std::uint8_t>(byte));
}

void append_word(Bytes& bytes, unsigned word) { append(bytes, {word & 0xFFU, word >> 8 & 0xFFU}); }

// SCIP ----------------------------------------------------------------------------------------------------------------

/// Returns the text with its check character: the sum of the bytes, 6 bits of it, from '0' on.
std::string checked(const std::string& text) {
    unsigned sum = 0;
    for (const char character : text) sum += static_cast<unsigned>(character);
    return text + static_cast<char>('0' + sum % 64);
}

std::string six_bits(std::uint32_t number, int characters) {
    std::string text;
    for (int i = characters - 1; i >= 0; --i) text += static_cast<char>('0' + (number >> 6 * i) % 64);
    return text;
}

/// Returns "NAME:value;" with its check character, which does not cover the ';'.
std::string setting(const std::string& text) {
    const std::string sum = checked(text);
    return text + ";" + sum.back() + "\n";
}

// A5 requests ---------------------------------------------------------------------------------------------------------

/// Takes the next request from the bytes. @return its command, or -1 without a complete one
int take_request(Bytes& received) {
    while (!received.empty() && received.front() != 0xA5) received.erase(received.begin());
    if (received.size() < 2) return -1;
    const int command = received[1];
    std::size_t size = 2;
    constexpr std::array kWithPayload{0x82, 0x84, 0xA8, 0xF0, 0xFF}; // of RPLIDARs
    const bool has_payload = std::ranges::find(kWithPayload, command) != kWithPayload.end();
    if (has_payload) {
        if (received.size() < 3 || received.size() < 4U + received[2]) return -1;
        size = 4U + received[2];
        unsigned check = 0;
        for (std::size_t i = 0; i < size; ++i) check ^= received[i];
        received.erase(received.begin(), received.begin() + static_cast<std::ptrdiff_t>(size));
        return check == 0 ? command : -1;
    }
    received.erase(received.begin(), received.begin() + static_cast<std::ptrdiff_t>(size));
    return command;
}

Bytes identity(const A5Emulation& emulation) {
    Bytes answer;
    append(answer,
           {0xA5, 0x5A, 0x14, 0, 0, 0, 0x04, emulation.model, emulation.firmware_minor, emulation.firmware_major, 7});
    for (unsigned i = 0; i < 16; ++i) append(answer, {0xA0 + i});
    return answer;
}

Bytes condition(const A5Emulation& emulation) {
    Bytes answer;
    append(answer, {0xA5, 0x5A, 0x03, 0, 0, 0, 0x06, emulation.condition, 0x02, 0x80});
    return answer;
}

unsigned distance_at(int degree) { return degree == 90 ? 0U : 1000U + 10U * static_cast<unsigned>(degree); }

} // namespace

Bytes HokuyoEmulator::receive(std::span<const std::uint8_t> bytes) {
    received_.append(bytes.begin(), bytes.end());
    std::string answers;
    for (std::size_t end = 0; (end = received_.find('\n')) != std::string::npos;) {
        const std::string command = received_.substr(0, end);
        received_.erase(0, end + 1);
        commands_.push_back(command);
        answers += command + "\n" + answer(command) + "\n";
    }
    return {answers.begin(), answers.end()};
}

std::string HokuyoEmulator::answer(const std::string& command) {
    if (command == "QT") measurement_.clear();
    if (command.starts_with("MD")) measurement_ = command;
    if (command == "VV") {
        return checked("00") + "\n" + setting("VEND:Hokuyo Automatic Co., Ltd.") + setting("PROD:UST-10LX") +
               setting("FIRM:CE00486") + setting("PROT:SCIP 2.2") + setting("SERI:H1234567");
    }
    if (command == "PP") {
        return checked("00") + "\n" + setting("MODL:UST-10LX") + setting("DMIN:20") + setting("DMAX:30000") +
               setting("ARES:1440") + setting("AMIN:0") + setting("AMAX:1080") + setting("AFRT:540") +
               setting("SCAN:2400");
    }
    const bool is_known = command == "QT" || command == "BM" || command == "HS0" || command.starts_with("MD");
    return checked(is_known ? "00" : "0E") + "\n"; // this sensor need not be switched to SCIP 2
}

Bytes HokuyoEmulator::next_turn() {
    constexpr std::size_t kBlock = 64;
    std::string data;
    for (unsigned step = 0; step < kSteps; ++step) {
        data += six_bits(step == 100 ? 7U : step == 200 ? 65'533U : 1000U + step, 3);
    }
    std::string text =
        measurement_ + "\n" + checked("99") + "\n" + checked(six_bits(milliseconds_ & 0xFF'FFFFU, 4)) + "\n";
    for (std::size_t at = 0; at < data.size(); at += kBlock) text += checked(data.substr(at, kBlock)) + "\n";
    text += "\n";
    milliseconds_ += 25;
    return {text.begin(), text.end()};
}

Bytes RplidarEmulator::receive(std::span<const std::uint8_t> bytes) {
    received_.insert(received_.end(), bytes.begin(), bytes.end());
    Bytes answers;
    for (int command = 0; (command = take_request(received_)) >= 0;) {
        commands_.push_back(fmt::format("{:02X}", command));
        if (emulation_.is_mute) continue;
        const auto answer = [&](const Bytes& more) { answers.insert(answers.end(), more.begin(), more.end()); };
        if (command == 0x25) measurement_ = Measurement::kNone;
        if (command == 0x50) answer(identity(emulation_));
        if (command == 0x52) answer(condition(emulation_));
        if (command == 0x20) {
            append(answers, {0xA5, 0x5A, 5, 0, 0, 0x40, 0x81});
            measurement_ = Measurement::kNodes;
        }
        if (command == 0x82 && emulation_.firmware_minor >= 17) {
            append(answers, {0xA5, 0x5A, 84, 0, 0, 0x40, 0x82});
            measurement_ = Measurement::kCapsules;
            is_first_capsule_ = true;
        }
    }
    return answers;
}

Bytes RplidarEmulator::next_turn() {
    Bytes bytes;
    if (measurement_ == Measurement::kNodes) {
        for (int degree = 0; degree < 360; ++degree) {
            const unsigned distance = distance_at(degree);
            append(bytes, {(distance > 0 ? 47U << 2 : 0U) | (degree == 0 ? 1U : 2U)});
            append_word(bytes, static_cast<unsigned>(degree) * 64U << 1 | 1U);
            append_word(bytes, distance * 4U);
        }
        return bytes;
    }
    constexpr int kPoints = 384; // 12 capsules of 30 degrees
    for (int first = 0; first < kPoints; first += 32) {
        Bytes data;
        append_word(data, static_cast<unsigned>(first * 360 * 64 / kPoints) | (is_first_capsule_ ? 0x8000U : 0U));
        is_first_capsule_ = false;
        for (int pair = first; pair < first + 32; pair += 2) {
            // the first of two points has the offset 1 degree, the second one 2 degrees
            append_word(data, distance_at(pair * 360 / kPoints) * 4U);
            append_word(data, distance_at((pair + 1) * 360 / kPoints) * 4U | 1U);
            append(data, {8U});
        }
        unsigned check = 0;
        for (const std::uint8_t byte : data) check ^= byte;
        append(bytes, {0xA0U | (check & 0xFU), 0x50U | check >> 4});
        bytes.insert(bytes.end(), data.begin(), data.end());
    }
    return bytes;
}

Bytes YdlidarEmulator::receive(std::span<const std::uint8_t> bytes) {
    received_.insert(received_.end(), bytes.begin(), bytes.end());
    Bytes answers;
    for (int command = 0; (command = take_request(received_)) >= 0;) {
        commands_.push_back(fmt::format("{:02X}", command));
        if (emulation_.is_mute || is_x2_) continue;
        const auto answer = [&](const Bytes& more) { answers.insert(answers.end(), more.begin(), more.end()); };
        if (command == 0x65) is_started_ = false;
        if (command == 0x90) answer(identity(emulation_));
        if (command == 0x92) answer(condition(emulation_));
        if (command == 0x60) {
            append(answers, {0xA5, 0x5A, 5, 0, 0, 0x40, 0x81});
            is_started_ = true;
        }
    }
    return answers;
}

Bytes YdlidarEmulator::next_turn() {
    Bytes bytes;
    const auto add_packet = [&](int first, int samples) {
        const unsigned type = first == 0 ? 1U : 0U;
        const auto angle = [](int degree) { return static_cast<unsigned>(degree) * 64U << 1 | 1U; };
        const unsigned count = static_cast<unsigned>(samples);
        std::vector<unsigned> words{0x55AA, count << 8 | type, angle(first), angle(first + samples - 1)};
        for (int i = first; i < first + samples; ++i) words.push_back(distance_at(i) * 4U);
        unsigned check = 0;
        for (const unsigned word : words) check ^= word;
        words.insert(words.begin() + 4, check);
        for (const unsigned word : words) append_word(bytes, word);
    };
    add_packet(0, 1); // the packet that marks the turn has one sample
    for (int first = 1; first < 360; first += 40) add_packet(first, std::min(40, 360 - first));
    return bytes;
}

Bytes Ld06Emulator::next_turn() {
    const int packet_angle = is_stl27l_ ? 200 : 960; // 0.01 degree, from one packet to the next
    const int packet_microseconds = is_stl27l_ ? 556 : 2667;
    const int packets_per_turn = is_stl27l_ ? 180 : 38;
    Bytes bytes;
    for (int packets = 0; packets < packets_per_turn; ++packets) {
        Bytes packet;
        append(packet, {0x54, 0x2C});
        append_word(packet, 3600);
        append_word(packet, static_cast<unsigned>(angle_));
        for (int i = 0; i < 12; ++i) {
            append_word(packet, 1000U + 10U * static_cast<unsigned>((angle_ + i * packet_angle / 12) % 36'000 / 100));
            append(packet, {200});
        }
        append_word(packet, static_cast<unsigned>((angle_ + 11 * packet_angle / 12) % 36'000));
        append_word(packet, static_cast<unsigned>(microseconds_ / 1000 % 30'000));
        unsigned crc = 0;
        for (const std::uint8_t byte : packet) {
            crc ^= byte;
            for (int bit = 0; bit < 8; ++bit) crc = ((crc & 0x80U) != 0 ? crc << 1 ^ 0x4DU : crc << 1) & 0xFFU;
        }
        append(packet, {crc});
        bytes.insert(bytes.end(), packet.begin(), packet.end());
        angle_ = (angle_ + packet_angle) % 36'000;
        microseconds_ += packet_microseconds;
    }
    return bytes;
}

std::unique_ptr<LidarEmulator> make_lidar_emulator(std::string_view model) {
    if (model == "ld06" || model == "ld19") return std::make_unique<Ld06Emulator>();
    if (model == "stl27l") return std::make_unique<Ld06Emulator>(true);
    if (model == "rplidar-a1") return std::make_unique<RplidarEmulator>(A5Emulation{.firmware_minor = 20});
    if (model == "rplidar-a2")
        return std::make_unique<RplidarEmulator>(A5Emulation{.model = 0x2C, .firmware_minor = 32});
    if (model == "rplidar-c1")
        return std::make_unique<RplidarEmulator>(A5Emulation{.model = 0x41, .firmware_minor = 2});
    if (model == "ydlidar-x2") return std::make_unique<YdlidarEmulator>(true);
    if (model == "ydlidar-x4") return std::make_unique<YdlidarEmulator>(false);
    if (model == "hokuyo") return std::make_unique<HokuyoEmulator>();
    return nullptr;
}

} // namespace scanloom::testing_support
