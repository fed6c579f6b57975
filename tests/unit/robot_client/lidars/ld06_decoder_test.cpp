#include "robot_client/lidars/ld06_packet.hpp"

#include "tests/support/ld06_bytes.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

namespace scanloom::robot {
namespace {

using testing_support::append;
using testing_support::Bytes;
using testing_support::bytes_of;
using testing_support::Ld06Spinner;

std::vector<Ld06Packet> all_of(Ld06Decoder& decoder) {
    std::vector<Ld06Packet> packets;
    while (const auto packet = decoder.next()) packets.push_back(*packet);
    return packets;
}

std::vector<Ld06Packet> decoded(Ld06Decoder& decoder, const Bytes& bytes) {
    decoder.feed(bytes);
    return all_of(decoder);
}

TEST(Ld06Decoder, FindsAdjacentPackets) {
    Ld06Spinner sensor;
    Ld06Decoder decoder;
    EXPECT_EQ(decoded(decoder, sensor.next_bytes(50)).size(), 50U);
    EXPECT_EQ(decoder.counts(), (Ld06Counts{.packets = 50}));
}

TEST(Ld06Decoder, RepeatedHeaderByteHidesNoPacket) {
    Ld06Spinner sensor;
    const Ld06Packet packet = sensor.next();
    Bytes bytes{0x54};
    append(bytes, bytes_of(packet));
    Ld06Decoder decoder;
    EXPECT_EQ(decoded(decoder, bytes), std::vector{packet});
    EXPECT_EQ(decoder.counts(), (Ld06Counts{.packets = 1, .skipped_bytes = 1}));
}

TEST(Ld06Decoder, FindsAPacketAfterATruncatedOne) {
    Ld06Spinner sensor;
    const Ld06Packet packet = sensor.next();
    const Bytes whole = bytes_of(packet);
    for (std::size_t cut = 2; cut < whole.size(); ++cut) { // the line failed for a moment, and the next packet follows
        Bytes bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(cut));
        append(bytes, whole);
        Ld06Decoder decoder;
        EXPECT_EQ(decoded(decoder, bytes), std::vector{packet}) << cut;
        EXPECT_EQ(decoder.counts(), (Ld06Counts{.packets = 1, .crc_failures = 1, .skipped_bytes = cut})) << cut;
    }
}

TEST(Ld06Decoder, SkipsBytesBetweenPackets) {
    std::mt19937 random(4);
    Ld06Spinner sensor;
    std::vector<Ld06Packet> sent;
    Bytes bytes;
    std::size_t garbage = 0;
    for (int i = 0; i < 300; ++i) {
        Bytes between(random() % 60);
        for (auto& byte : between) byte = static_cast<std::uint8_t>(random());
        if (i % 3 == 0) append(between, {0x54, 0x2C, 0x54});
        garbage += between.size();
        append(bytes, between);
        sent.push_back(sensor.next());
        append(bytes, bytes_of(sent.back()));
    }
    Ld06Decoder decoder;
    EXPECT_EQ(decoded(decoder, bytes), sent);
    EXPECT_EQ(decoder.counts().skipped_bytes, garbage);
    EXPECT_GE(decoder.counts().crc_failures, 100U);
}

TEST(Ld06Decoder, AnySplitOfTheBytesGivesEqualPackets) {
    std::mt19937 random(9);
    Ld06Spinner sensor;
    Bytes bytes;
    for (int i = 0; i < 60; ++i) {
        append(bytes, sensor.next_bytes(1));
        if (random() % 3 == 0) bytes[random() % bytes.size()] ^= static_cast<std::uint8_t>(1U << random() % 8);
        if (random() % 5 == 0) append(bytes, {0x54, 0x54, 0x2C, 0x2C, 0x07});
    }
    Ld06Decoder whole;
    const auto expected = decoded(whole, bytes);
    EXPECT_GT(expected.size(), 30U);
    EXPECT_LT(expected.size(), 60U);
    for (std::size_t size_max : {1U, 2U, 46U, 47U, 48U, 200U}) {
        Ld06Decoder decoder;
        std::vector<Ld06Packet> packets;
        for (std::size_t at = 0; at < bytes.size();) {
            const std::size_t size = std::min(bytes.size() - at, size_max == 1 ? 1 : 1 + random() % size_max);
            decoder.feed(std::span(bytes).subspan(at, size));
            at += size;
            for (const auto& packet : all_of(decoder)) packets.push_back(packet);
        }
        EXPECT_EQ(packets, expected);
        EXPECT_EQ(decoder.counts(), whole.counts());
    }
}

TEST(Ld06Decoder, ImplausiblePacketsAreCountedAndDropped) {
    Ld06Spinner sensor;
    Ld06Packet wrong = sensor.next();
    wrong.start_angle = 40'000;
    Bytes bytes = bytes_of(wrong);
    const Ld06Packet right = sensor.next();
    append(bytes, bytes_of(right));
    Ld06Decoder decoder;
    EXPECT_EQ(decoded(decoder, bytes), std::vector{right});
    EXPECT_EQ(decoder.counts(), (Ld06Counts{.packets = 1, .implausible = 1}));
}

TEST(Ld06Decoder, RestartDiscardsThePartialPacket) {
    Ld06Spinner sensor;
    const Bytes first = bytes_of(sensor.next());
    const Bytes second = bytes_of(sensor.next());
    Ld06Decoder decoder;
    decoder.feed(std::span(first).first(20));
    EXPECT_FALSE(decoder.next());
    decoder.restart();
    EXPECT_EQ(decoded(decoder, second).size(), 1U);
    EXPECT_EQ(decoder.counts(), (Ld06Counts{.packets = 1})) << "a truncated packet is not counted as damaged";
}

TEST(Ld06Decoder, FindsThePacketsOfARealRecording) {
    const std::filesystem::path path = SCANLOOM_SOURCE_DIR "/../shared/data/ld06/capture.bin";
    if (!std::filesystem::exists(path))
        GTEST_SKIP() << "recorded data, no part of the project, are not on this machine: " << path;
    std::ifstream file(path, std::ios::binary);
    const std::string text(std::istreambuf_iterator<char>(file), {});
    Ld06Decoder decoder;
    EXPECT_EQ(decoded(decoder, Bytes(text.begin(), text.end())).size(), 8441U);
    EXPECT_EQ(decoder.counts(), (Ld06Counts{.packets = 8441, .crc_failures = 3, .skipped_bytes = 160}));
}

} // namespace
} // namespace scanloom::robot
