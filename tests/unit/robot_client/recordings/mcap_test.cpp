#include "robot_client/recordings/mcap.hpp"

#include "tests/support/mcap_writer.hpp"
#include "tests/unit/robot_client/recordings/read_recording.hpp"

#include <gmock/gmock.h>

namespace scanloom::robot {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;
using testing_support::McapOptions;
using testing_support::McapWriter;
using testing_support::small_mcap;

constexpr std::size_t kMcapMagicBytes = 8;

class WholeMcap : public testing::TestWithParam<std::tuple<const char*, std::size_t>> {};

TEST_P(WholeMcap, YieldsEveryMessageInOrder) {
    const auto [compression, chunk_bytes] = GetParam();
    const auto mcap = small_mcap({.compression = compression, .chunk_bytes = chunk_bytes}, 200);
    const auto read = read_mcap(mcap.file);
    EXPECT_EQ(read.messages, all_of(mcap));
    EXPECT_THAT(read.topics, ElementsAre(RecordedTopic{"/scan", "sensor_msgs/LaserScan", MessageEncoding::kCdr},
                                         RecordedTopic{"/odom", "nav_msgs/Odometry", MessageEncoding::kCdr}));
    EXPECT_EQ(read.losses_count, 0U);
    EXPECT_EQ(read.progress.bytes, mcap.file.size());
}

INSTANTIATE_TEST_SUITE_P(Each, WholeMcap,
                         testing::Combine(testing::Values("", "lz4", "zstd"),
                                          testing::Values(std::size_t{0}, std::size_t{1}, std::size_t{900},
                                                          std::size_t{1} << 20)));

class DamagedMcap : public testing::TestWithParam<const char*> {
protected:
    [[nodiscard]] static McapOptions options() {
        const std::string name = GetParam();
        if (name == "none") return {.has_checksums = false};
        if (name == "unchunked") return {.chunk_bytes = 0};
        return {.compression = name};
    }
};

TEST_P(DamagedMcap, CutAtAnyByteYieldsItsWholeMessages) {
    expect_cuts_yield_whole_messages(small_mcap(options()), read_mcap, kMcapMagicBytes);
}

TEST_P(DamagedMcap, DamageAtAnyByteCostsOneRecordOrChunk) {
    expect_damage_stays_local(small_mcap(options()), read_mcap, kMcapMagicBytes);
}

INSTANTIATE_TEST_SUITE_P(Each, DamagedMcap, testing::Values("none", "unchunked", "lz4", "zstd"),
                         [](const auto& each) { return std::string(each.param); });

TEST(Mcap, ChunkWithWrongChecksumIsALossAsAWhole) {
    for (const char* compression : {"", "lz4"}) {
        auto mcap = small_mcap({.compression = compression});
        const auto all = all_of(mcap);
        if (*compression == '\0') {
            mcap.file[mcap.messages[0].end - 1] ^= 1; // the message itself
        } else {
            mcap.file[mcap.messages[0].begin + 9 + 24] ^= 1; // the checksum
        }
        const auto read = read_mcap(mcap.file);
        ASSERT_LT(read.messages.size(), all.size()) << compression;
        EXPECT_TRUE(std::equal(read.messages.rbegin(), read.messages.rend(), all.rbegin())) << "the rest is read";
        ASSERT_THAT(read.losses, SizeIs(1));
        EXPECT_THAT(read.losses[0].reason, HasSubstr("checksum is wrong"));
    }
}

TEST(Mcap, MessagesOfALostDescriptionAreReadByTheSummary) {
    auto mcap = small_mcap({.has_checksums = false});
    ASSERT_THAT(mcap.descriptions, SizeIs(2));
    const auto topics = read_mcap(mcap.file).topics;
    std::fill_n(mcap.file.begin() + static_cast<std::ptrdiff_t>(mcap.descriptions[0].begin), 9, '\0');
    const auto read = read_mcap(mcap.file);
    EXPECT_EQ(read.messages, all_of(mcap));
    EXPECT_EQ(read.topics, topics) << "also the types, which only the schemas say";
    EXPECT_EQ(read.losses_count, 1U);
}

TEST(Mcap, ASchemaMayFollowItsChannel) {
    for (const char* compression : {"", "lz4"}) { // a search does not look into compressed chunks
        const McapOptions options{.compression = compression, .has_summary = false, .has_late_schemas = true};
        const auto mcap = small_mcap(options);
        const auto read = read_mcap(mcap.file);
        EXPECT_EQ(read.messages, all_of(mcap));
        EXPECT_EQ(read.topics, read_mcap(small_mcap().file).topics);
        EXPECT_EQ(read.losses_count, 0U);
    }
}

TEST(Mcap, WithoutSummaryOrEndYieldsAll) {
    const auto without_summary = small_mcap({.has_summary = false});
    EXPECT_EQ(read_mcap(without_summary.file).messages, all_of(without_summary));
    EXPECT_EQ(read_mcap(without_summary.file).losses_count, 0U);
    const auto unclosed = small_mcap({.is_closed = false});
    const auto read = read_mcap(unclosed.file);
    EXPECT_EQ(read.messages, all_of(unclosed));
    ASSERT_THAT(read.losses, SizeIs(1));
    EXPECT_THAT(read.losses[0].reason, HasSubstr("was not closed"));
}

TEST(Mcap, UnknownRecordsAreSkippedAndNothingBehindTheEndIsRead) {
    McapWriter writer;
    const auto channel = writer.connect("/scan", "sensor_msgs/msg/LaserScan");
    writer.write(channel, 1, "a");
    writer.write_raw(McapWriter::record(0x85, "private") + McapWriter::record(0x20, "of a later version"));
    writer.write(channel, 2, "b");
    writer.write_raw(McapWriter::record(0x09, std::string(200, 'a'))); // an attachment
    writer.write(channel, 3, "c");
    writer.write_raw(McapWriter::record(0x0f, std::string(4, '\0')));
    writer.write(channel, 4, "d");
    const auto read = read_mcap(writer.finish().file);
    EXPECT_THAT(read.messages,
                ElementsAre(ReadMessage{"/scan", 1, "a"}, ReadMessage{"/scan", 2, "b"}, ReadMessage{"/scan", 3, "c"}));
    EXPECT_EQ(read.losses_count, 0U);
}

TEST(Mcap, EncodingsAreToldApart) {
    McapWriter writer;
    for (const char* encoding : {"ros1", "cdr", "json", "protobuf"}) {
        writer.write(writer.connect("/a", "sensor_msgs/LaserScan", encoding), 1, "x");
    }
    writer.write(writer.connect("/a", "sensor_msgs/msg/LaserScan", "ros1"), 1, "x");
    EXPECT_THAT(read_mcap(writer.finish().file).topics,
                ElementsAre(RecordedTopic{"/a", "sensor_msgs/LaserScan", MessageEncoding::kRos1},
                            RecordedTopic{"/a", "sensor_msgs/LaserScan", MessageEncoding::kCdr},
                            RecordedTopic{"/a", "sensor_msgs/LaserScan", MessageEncoding::kOther}));
}

TEST(Mcap, MessagesCompressedOneByOneAreDecompressed) {
    const std::string scan = std::string("\0\1\0\0", 4) + std::string(1000, 's');
    McapWriter writer;
    const auto channel = writer.connect("/scan", "sensor_msgs/msg/LaserScan");
    const auto other = writer.connect("/blob", "blob", "json");
    writer.write(channel, 1, testing_support::zstd_compressed(scan));
    writer.write(channel, 2, scan);
    writer.write(channel, 3, testing_support::zstd_compressed(scan).substr(0, 12));
    writer.write(other, 4, testing_support::zstd_compressed(scan));
    const auto read = read_mcap(writer.finish().file);
    EXPECT_THAT(read.messages, ElementsAre(ReadMessage{"/scan", 1, scan}, ReadMessage{"/scan", 2, scan},
                                           ReadMessage{"/blob", 4, testing_support::zstd_compressed(scan)}));
    EXPECT_EQ(read.losses_count, 1U);
}

TEST(Mcap, TimesBeyondTheYear2262AreTheLastOne) {
    McapWriter writer;
    writer.write(writer.connect("/scan", "sensor_msgs/msg/LaserScan"), -1, "x");
    EXPECT_EQ(read_mcap(writer.finish().file).messages.at(0).time, std::numeric_limits<std::int64_t>::max());
}

TEST(Mcap, ChunkOfUnknownCompressionIsALoss) {
    McapWriter writer;
    const auto channel = writer.connect("/scan", "sensor_msgs/msg/LaserScan");
    writer.write(channel, 1, "a");
    std::string content(8 + 8 + 8 + 4, '\0');
    testing_support::append_counted(content, "\x1b"
                                             "7z");
    testing_support::append_little(content, std::uint64_t{100});
    writer.write_raw(McapWriter::record(0x06, content + std::string(100, 'p')));
    writer.write(channel, 2, "b");
    const auto read = read_mcap(writer.finish().file);
    EXPECT_THAT(read.messages, ElementsAre(ReadMessage{"/scan", 1, "a"}, ReadMessage{"/scan", 2, "b"}));
    ASSERT_THAT(read.losses, SizeIs(1));
    EXPECT_THAT(read.losses[0].reason, HasSubstr("unknown compression '?7z'"));
}

TEST(Mcap, OtherVersionsAreRefused) {
    const auto open = [](std::string_view bytes) {
        return open_mcap(std::make_unique<BytesInMemory>(bytes), "a.mcap").error();
    };
    EXPECT_EQ(open("\x89MCAP1\r\n").code, Errc::kUnsupportedVersion);
    EXPECT_THAT(open("\x89MCAP1\r\n").message, HasSubstr("a.mcap: an MCAP file of version '1'"));
    EXPECT_EQ(open("\x89MCAP0\n").code, Errc::kMalformed);
    EXPECT_EQ(open("").code, Errc::kMalformed);
}

} // namespace
} // namespace scanloom::robot
