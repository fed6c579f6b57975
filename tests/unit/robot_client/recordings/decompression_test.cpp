#include "robot_client/recordings/decompression.hpp"

#include "robot_client/recordings/lz4_tail.hpp"
#include "tests/support/written_recording.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

namespace scanloom::robot {
namespace {

using testing::HasSubstr;
using testing::Optional;

struct NamedCompression {
    const char* name;
    Compression compression;
};

/// Bytes that become about half as large.
std::string half_random(std::size_t size) {
    std::mt19937 random(5);
    std::string bytes(size, '\0');
    for (auto& byte : bytes) byte = static_cast<char>('a' + random() % 16);
    return bytes;
}

class Decompression : public testing::TestWithParam<NamedCompression> {
protected:
    [[nodiscard]] static std::string pack(std::string_view bytes) {
        return testing_support::compressed(GetParam().name, bytes);
    }
    std::optional<std::string> unpack(std::string_view packed, std::size_t size_max = std::size_t{1} << 30U) {
        return decompress(GetParam().compression, packed, size_max, bytes_);
    }

    std::string bytes_ = "of an earlier call";
};

TEST_P(Decompression, ReturnsWhatWasCompressed) {
    for (const std::size_t size : {0U, 1U, 65'536U, 1'000'000U}) {
        const std::string text = half_random(size);
        EXPECT_EQ(unpack(pack(text)), std::nullopt) << size;
        EXPECT_EQ(bytes_, text);
        EXPECT_EQ(unpack(pack(text) + "behind it", size), std::nullopt) << "exactly so much is allowed";
        EXPECT_EQ(bytes_, text);
    }
}

TEST_P(Decompression, StreamsInSequenceAreOneText) {
    std::string packed;
    std::string text;
    for (std::size_t i = 0; i < 2000; ++i) {
        text += half_random(i % 3);
        packed += pack(half_random(i % 3));
    }
    EXPECT_EQ(unpack(packed), std::nullopt);
    EXPECT_EQ(bytes_, text);
}

TEST_P(Decompression, BombIsStoppedAtTheLimit) {
    const std::string packed = pack(std::string(50'000'000, 'x'));
    ASSERT_LT(packed.size(), 300'000U);
    std::string bytes;
    EXPECT_THAT(decompress(GetParam().compression, packed, 1000, bytes), Optional(HasSubstr("larger than 1000 bytes")));
    EXPECT_EQ(bytes, std::string(1000, 'x'));
    EXPECT_LT(bytes.capacity(), 100'000U);
}

TEST_P(Decompression, TruncatedDataYieldsWhatIsBefore) {
    const std::string text = half_random(1'000'000);
    const std::string packed = pack(text);
    for (const double share : {0.0, 0.00001, 0.3, 0.7, 0.999}) {
        const auto size = static_cast<std::size_t>(share * static_cast<double>(packed.size()));
        EXPECT_THAT(unpack(std::string_view(packed).substr(0, size)), Optional(HasSubstr("truncated")));
        EXPECT_TRUE(text.starts_with(bytes_));
        EXPECT_GE(static_cast<double>(bytes_.size()), share * 1e6 - 350'000) << share;
    }
}

TEST_P(Decompression, DamagedDataYieldsNothingWrongOfWhatHasAChecksum) {
    const std::string text = half_random(250'000);
    std::string packed = pack(text);
    for (std::size_t at = packed.size() / 2; at < packed.size(); at += packed.size() / 60) {
        packed[at] = static_cast<char>(packed[at] ^ 0x10);
        const auto reason = unpack(packed, text.size());
        // zstd data as MCAP has it has no checksum; the chunk has one.
        if (GetParam().compression != Compression::kZstd) {
            EXPECT_TRUE(reason);
            EXPECT_TRUE(text.starts_with(bytes_)) << "byte " << at;
        }
        packed[at] = static_cast<char>(packed[at] ^ 0x10);
    }
}

TEST_P(Decompression, OtherBytesAreDamaged) {
    EXPECT_THAT(unpack("not compressed at all, but long enough to be"), Optional(HasSubstr("damaged")));
    EXPECT_EQ(bytes_, "");
}

INSTANTIATE_TEST_SUITE_P(Each, Decompression,
                         testing::Values(NamedCompression{"bz2", Compression::kBzip2},
                                         NamedCompression{"lz4", Compression::kLz4},
                                         NamedCompression{"zstd", Compression::kZstd}),
                         [](const auto& each) { return std::string(each.param.name); });

/// Text with matches near and far, and long runs.
std::string text_with_matches(std::size_t size) {
    std::mt19937 random(7);
    std::string text;
    while (text.size() < size) {
        if (random() % 3 == 0) text += fmt::format("scan {} ", random() % 1000);
        if (random() % 3 == 0) text += std::string(random() % 400, static_cast<char>('a' + random() % 3));
        if (text.size() > 1000) text += text.substr(random() % (text.size() - 500), random() % 300);
    }
    text.resize(size);
    return text;
}

/// Decompresses truncated data with the block at which it ends.
std::string with_tail(std::string_view packed, std::size_t size_max) {
    std::string bytes;
    EXPECT_TRUE(decompress(Compression::kLz4, packed, size_max, bytes)) << "it is truncated";
    append_truncated_lz4_block(packed, size_max, bytes);
    return bytes;
}

TEST(Lz4Tail, BlockCutAnywhereYieldsWhatIsBefore) {
    const std::string text = text_with_matches(20'000);
    const std::string packed = testing_support::lz4_compressed(text, LZ4F_max4MB);
    std::size_t last = 0;
    for (std::size_t size = 0; size < packed.size(); ++size) {
        const std::string bytes = with_tail(std::string_view(packed).substr(0, size), text.size());
        ASSERT_TRUE(text.starts_with(bytes)) << size;
        ASSERT_GE(bytes.size(), last) << size;
        last = bytes.size();
    }
    EXPECT_EQ(last, text.size());
}

TEST(Lz4Tail, LinkedBlocksReferToThoseBefore) {
    const std::string text = text_with_matches(300'000);
    const std::string packed = testing_support::lz4_compressed(text, LZ4F_max64KB, LZ4F_blockLinked);
    for (std::size_t size = packed.size() / 3; size < packed.size(); size += 997) {
        const std::string bytes = with_tail(std::string_view(packed).substr(0, size), text.size());
        ASSERT_TRUE(text.starts_with(bytes)) << size;
        const double share = static_cast<double>(size) / static_cast<double>(packed.size());
        EXPECT_NEAR(static_cast<double>(bytes.size()), share * 300'000, 20'000) << size;
    }
}

TEST(Lz4Tail, MatchBeforeTheBeginningEndsTheText) {
    // A frame without checksums; a block of 100 bytes that begins with a literal and a match 9 bytes before its end.
    const std::string packed("\x04\x22\x4d\x18\x60\x40\0"
                             "\x64\0\0\0"
                             "\x10"
                             "a"
                             "\x09\0",
                             15);
    std::string bytes;
    append_truncated_lz4_block(packed, 1000, bytes);
    EXPECT_EQ(bytes, "a");
}

TEST(Lz4Tail, NeverExceedsTheLimit) {
    const std::string packed = testing_support::lz4_compressed(std::string(1'000'000, 'x'), LZ4F_max4MB);
    EXPECT_EQ(with_tail(std::string_view(packed).substr(0, packed.size() - 20), 1000), std::string(1000, 'x'));
    EXPECT_EQ(with_tail(std::string_view(packed).substr(0, 100), 1000), std::string(1000, 'x'));
}

} // namespace
} // namespace scanloom::robot
