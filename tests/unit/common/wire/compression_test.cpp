#include "common/wire/compression.hpp"

#include "common/wire/frame_decoder.hpp"
#include "tests/unit/common/wire/example_messages.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zstd.h>

#include <limits>

namespace scanloom::wire {
namespace {

using testing::HasSubstr;

std::string zstd_of(std::string_view bytes) {
    std::string out(ZSTD_compressBound(bytes.size()), '\0');
    out.resize(ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), 1));
    return out;
}

CompressedScanBatch holding(const std::string& body) {
    return {static_cast<std::uint32_t>(body.size()), zstd_of(body)};
}

/// Returns similar but different scans, as a sensor gives them.
ScanBatch many_scans() {
    ScanBatch batch{std::vector<Scan>(20, example_scan(1))};
    for (std::size_t i = 0; i < batch.scans.size(); ++i) {
        batch.scans[i].seq = i + 1;
        batch.scans[i].pose->x += 0.01 * static_cast<double>(i);
    }
    return batch;
}

TEST(Compression, DecompressingReturnsTheOriginal) {
    Compressor compressor;
    for (int again = 0; again < 2; ++again) {
        const auto body = body_of(many_scans());
        const auto compressed = compressor.compress(body);
        ASSERT_TRUE(compressed);
        EXPECT_LT(2 * compressed->zstd.size(), body.size());
        EXPECT_EQ(bytes_under_way(*compressed), body.size() + kLengthPrefixBytes)
            << "credit counts the uncompressed frame";
        EXPECT_EQ(decompress(*compressed).value(), many_scans());
    }
}

TEST(Compression, IncompressibleFrameIsNotCompressed) {
    EXPECT_FALSE(Compressor().compress(body_of(Ping{0x123456789abcdef0})));
}

TEST(Compression, DecompressionBombIsRefusedBeforeAllocation) {
    const auto bomb = zstd_of(std::string(std::size_t{64} << 20, '\0'));
    EXPECT_LT(bomb.size(), std::size_t{10'000});
    const auto refused = decompress({std::uint32_t{64} << 20, bomb});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::kTooLarge);
    EXPECT_THAT(refused.error().message, HasSubstr("compressed_scan_batch.size is 67108864, at most 1048576"));
    EXPECT_EQ(decompress({1000, bomb}).error().code, Errc::kMalformed) << "the stated size is small";
}

TEST(Compression, DamagedDataIsRefusedByName) {
    const auto whole = holding(body_of(many_scans()));
    for (std::size_t i = 0; i < whole.zstd.size(); ++i) {
        auto damaged = whole;
        damaged.zstd[i] = static_cast<char>(damaged.zstd[i] ^ 0x10);
        const auto read = decompress(damaged); // There is no checksum: some damage gives other scans or invalid fields.
        EXPECT_TRUE(read || !read.error().message.empty());
        damaged.zstd.resize(i);
        EXPECT_EQ(decompress(damaged).error().code, Errc::kMalformed) << i << " of its bytes";
    }
    EXPECT_THAT(decompress({17, ""}).error().message, HasSubstr("no Zstandard frame"));
}

TEST(Compression, OnlyScanBatchesMayBeCompressed) {
    for (const std::string& other : {body_of(Ping{1}), body_of(Hello{}), body_of(holding(body_of(many_scans())))}) {
        const auto refused = decompress(holding(other));
        ASSERT_FALSE(refused);
    }
    EXPECT_THAT(decompress(holding(body_of(Ping{1}))).error().message, HasSubstr("holds a ping, no scan_batch"));
}

TEST(Compression, CompressedValuesAreValidated) {
    auto batch = many_scans();
    batch.scans[3].pose->x = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THAT(decompress(holding(body_of(batch))).error().message,
                HasSubstr("compressed_scan_batch: scan_batch.scans[3].pose.x is nan"));
}

} // namespace
} // namespace scanloom::wire
