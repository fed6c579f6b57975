#include "common/wire/frame_checksum.hpp"

#include "common/hash/crc32c.hpp"
#include "common/wire/frame_decoder.hpp"
#include "tests/support/plain_frame.hpp"
#include "tests/unit/common/wire/example_messages.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

namespace scanloom::wire {
namespace {

std::string frame_of(const Message& message) {
    std::string frame;
    encode(message, frame);
    return frame;
}

/// Returns the frame of a program that does not send checksums.
std::string without_checksum(const Message& message) {
    const auto frame = frame_of(message);
    std::string plain;
    testing_support::append_plain_frame(
        plain, std::string_view(frame).substr(kLengthPrefixBytes, frame.size() - kLengthPrefixBytes - kChecksumBytes));
    return plain;
}

/// Decodes a complete stream.
/// @return number of frames, or the error that ended decoding
Result<std::size_t> frames_in(std::string_view stream) {
    FrameDecoder decoder(kFrameBytesMax);
    std::memcpy(decoder.prepare(stream.size()).data(), stream.data(), stream.size());
    decoder.commit(stream.size());
    for (std::size_t frames = 0;; ++frames) {
        const auto body = decoder.next();
        if (!body) return body.error();
        if (!*body) return frames;
    }
}

TEST(FrameChecksum, MatchesTheDocumentedExample) {
    EXPECT_EQ(frame_of(Ping{1}), std::string("\0\0\0\x11"
                                             "\x3a\x09"
                                             "\x09\x01\0\0\0\0\0\0\0"
                                             "\xfd\x7f"
                                             "\xaf\x44\xac\x43",
                                             21));
}

TEST(FrameChecksum, EveryFlippedBitAfterTheLengthIsDetected) {
    const std::string first = frame_of(Ping{7});
    const std::string good = frame_of(ScanBatch{{example_scan(1)}});
    ASSERT_EQ(frames_in(first + good).value(), 2U);
    for (std::size_t bit = kLengthPrefixBytes * 8; bit < good.size() * 8; ++bit) {
        std::string damaged = good;
        damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ 1 << bit % 8);
        const auto read = frames_in(first + damaged);
        ASSERT_FALSE(read) << "bit " << bit;
        EXPECT_EQ(read.error().code, Errc::kDamaged) << "bit " << bit;
    }
}

TEST(FrameChecksum, FramesWithoutChecksumAreAccepted) {
    const std::string stream = without_checksum(Ping{1}) + without_checksum(ScanBatch{{example_scan(1)}});
    EXPECT_EQ(frames_in(stream).value(), 2U);
    EXPECT_EQ(frames_in(stream + frame_of(Ping{2})).value(), 3U) << "a program may start to send checksums";
}

TEST(FrameChecksum, MissingChecksumAfterAFirstOneIsDamage) {
    const auto read = frames_in(frame_of(Ping{1}) + without_checksum(Ping{2}));
    ASSERT_FALSE(read);
    EXPECT_EQ(read.error().code, Errc::kDamaged);
    EXPECT_THAT(read.error().message, testing::HasSubstr("missing"));
}

/// A range of 16.381 m is encoded like the checksum field's tag.
TEST(FrameChecksum, ScansThatResembleAChecksumAreAccepted) {
    std::string body("\x22\x08\xfd\x7f\xfd\x7f\x01\x02\x03\x04", 10);
    EXPECT_EQ(checksum_of(body), Checksum::kAbsent);
    const auto field = checksum_field(body);
    EXPECT_EQ(checksum_of(body.append(field.data(), field.size())), Checksum::kRight);
}

} // namespace
} // namespace scanloom::wire
