#include "common/wire/frame_decoder.hpp"
#include "tests/support/plain_frame.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <random>

namespace scanloom::wire {
namespace {

void feed(FrameDecoder& decoder, std::string_view bytes) {
    if (bytes.empty()) return; // memcpy must not get a null pointer, even for zero bytes
    std::memcpy(decoder.prepare(bytes.size()).data(), bytes.data(), bytes.size());
    decoder.commit(bytes.size());
}

std::vector<std::string> drain(FrameDecoder& decoder) {
    std::vector<std::string> bodies;
    for (auto body = decoder.next(); body && *body; body = decoder.next()) bodies.emplace_back(**body);
    return bodies;
}

std::string stream_of(const std::vector<std::string>& bodies) {
    std::string stream;
    for (const auto& body : bodies) testing_support::append_plain_frame(stream, body);
    return stream;
}

const std::vector<std::string> kBodies = {"a", std::string(300, 'b'), "ccc", std::string("\0\0\0\1", 4), "e"};

TEST(FrameDecoder, AnySplitInTwoYieldsEqualBodies) {
    const std::string stream = stream_of(kBodies);
    for (std::size_t split = 0; split <= stream.size(); ++split) {
        FrameDecoder decoder(1000);
        feed(decoder, std::string_view(stream).substr(0, split));
        auto bodies = drain(decoder);
        feed(decoder, std::string_view(stream).substr(split));
        for (auto& body : drain(decoder)) bodies.push_back(std::move(body));
        EXPECT_EQ(bodies, kBodies) << "split after " << split << " bytes";
    }
}

TEST(FrameDecoder, AnyRandomSplitYieldsEqualBodies) {
    std::mt19937 random(11);
    for (int round = 0; round < 2000; ++round) {
        std::vector<std::string> sent(1 + random() % 8);
        for (auto& body : sent) body = std::string(1 + random() % 700, static_cast<char>(random() % 256));
        const std::string stream = stream_of(sent);
        FrameDecoder decoder(1000);
        std::vector<std::string> received;
        for (std::size_t at = 0; at < stream.size();) {
            const std::size_t length = std::min<std::size_t>(1 + random() % 97, stream.size() - at);
            feed(decoder, std::string_view(stream).substr(at, length));
            at += length;
            if (random() % 3 != 0) {
                for (auto& body : drain(decoder)) received.push_back(std::move(body));
            }
        }
        for (auto& body : drain(decoder)) received.push_back(std::move(body));
        ASSERT_EQ(received, sent) << "round " << round;
    }
}

TEST(FrameDecoder, OversizedFrameIsRefusedByItsLength) {
    FrameDecoder decoder(1000);
    feed(decoder, std::string_view("\x00\x00\x03\xe9", 4));
    const auto body = decoder.next();
    ASSERT_FALSE(body);
    EXPECT_EQ(body.error().code, Errc::kTooLarge);
    EXPECT_THAT(body.error().message, testing::HasSubstr("1001 bytes, at most 1000"));
    feed(decoder, stream_of({"fine"}));
    EXPECT_FALSE(decoder.next()) << "after an error, frame boundaries are unknown";
}

TEST(FrameDecoder, FrameOfMaximumSizeIsAccepted) {
    FrameDecoder decoder(1000);
    feed(decoder, stream_of({std::string(1000, 'x')}));
    EXPECT_EQ(drain(decoder).size(), 1U);
}

TEST(FrameDecoder, HttpIsRecognised) {
    for (const auto* text : {"GET / HTTP/1.1\r\n", "HTTP/1.1 400 Bad Request\r\n"}) {
        FrameDecoder decoder(1000);
        feed(decoder, text);
        const auto body = decoder.next();
        ASSERT_FALSE(body);
        EXPECT_EQ(body.error().code, Errc::kMalformed);
        EXPECT_THAT(body.error().message, testing::HasSubstr("connect robots to the robot port"));
        EXPECT_TRUE(decoder.holds_http());
    }
}

TEST(FrameDecoder, TlsIsRecognised) {
    FrameDecoder decoder(1000);
    feed(decoder, std::string_view("\x16\x03\x01\x02\x00\x01", 6));
    const auto body = decoder.next();
    ASSERT_FALSE(body);
    EXPECT_EQ(body.error().code, Errc::kMalformed);
    EXPECT_THAT(body.error().message, testing::HasSubstr("a TLS handshake"));
}

} // namespace
} // namespace scanloom::wire
