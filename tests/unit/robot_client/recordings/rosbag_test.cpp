#include "robot_client/recordings/rosbag.hpp"

#include "tests/support/bag_writer.hpp"
#include "tests/unit/robot_client/recordings/read_recording.hpp"

#include <gmock/gmock.h>

namespace scanloom::robot {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using testing_support::BagOptions;
using testing_support::BagWriter;
using testing_support::small_bag;

constexpr std::size_t kBagMagicBytes = 13;

Error error_of_bag(std::string_view bytes) {
    auto recording = open_rosbag(std::make_unique<BytesInMemory>(bytes), "a.bag");
    EXPECT_FALSE(recording);
    return recording ? Error{} : recording.error();
}

class WholeBag : public testing::TestWithParam<std::tuple<const char*, std::size_t>> {};

TEST_P(WholeBag, YieldsEveryMessageInOrder) {
    const auto [compression, chunk_bytes] = GetParam();
    const auto bag = small_bag({.compression = compression, .chunk_bytes = chunk_bytes}, 200);
    const auto read = read_bag(bag.file);
    EXPECT_EQ(read.messages, all_of(bag));
    EXPECT_THAT(read.topics, ElementsAre(RecordedTopic{"/scan", "sensor_msgs/LaserScan", MessageEncoding::kRos1},
                                         RecordedTopic{"/odom", "nav_msgs/Odometry", MessageEncoding::kRos1}));
    EXPECT_EQ(read.losses_count, 0U);
    EXPECT_EQ(read.progress.bytes, bag.file.size());
    EXPECT_EQ(read.progress.bytes_total, bag.file.size());
}

INSTANTIATE_TEST_SUITE_P(Each, WholeBag,
                         testing::Combine(testing::Values("none", "bz2", "lz4"),
                                          testing::Values(std::size_t{1}, std::size_t{900}, std::size_t{1} << 20)));

class DamagedBag : public testing::TestWithParam<const char*> {};

TEST_P(DamagedBag, CutAtAnyByteYieldsItsWholeMessages) {
    const auto bag = small_bag({.compression = GetParam()});
    expect_cuts_yield_whole_messages(bag, read_bag, kBagMagicBytes);
}

TEST_P(DamagedBag, DamageAtAnyByteCostsOneRecordOrChunk) {
    // The padding of the bag's header is not looked at; damage there needs no test of each byte.
    auto bag = small_bag({.compression = GetParam()});
    expect_damage_stays_local(bag, read_bag, kBagMagicBytes + 4000);
    bag.file.resize(4096 + kBagMagicBytes + 200);
    std::erase_if(bag.messages, [&](const auto& each) { return each.end > bag.file.size(); });
    std::string head = bag.file;
    for (std::size_t at = kBagMagicBytes; at < kBagMagicBytes + 80; ++at) {
        head[at] = static_cast<char>(head[at] ^ 0x40);
        ASSERT_TRUE(has_in_order(read_bag(head).messages, all_of(bag))) << at;
        head[at] = bag.file[at];
    }
}

INSTANTIATE_TEST_SUITE_P(Each, DamagedBag, testing::Values("none", "bz2", "lz4"),
                         [](const auto& each) { return std::string(each.param); });

TEST(Rosbag, WithoutIndexYieldsAllAndReportsThatItWasNotClosed) {
    const auto bag = small_bag({.is_closed = false});
    const auto read = read_bag(bag.file);
    EXPECT_EQ(read.messages, all_of(bag));
    ASSERT_THAT(read.losses, SizeIs(1));
    EXPECT_THAT(read.losses[0].reason, HasSubstr("was not closed"));
}

TEST(Rosbag, LastChunkWithoutSizesIsRead) {
    for (const char* compression : {"none", "bz2", "lz4"}) {
        const auto bag = small_bag({.compression = compression, .is_closed = false, .has_sizes = false}, 11);
        EXPECT_EQ(read_bag(bag.file).messages, all_of(bag)) << compression;
    }
}

TEST(Rosbag, IndexRecordsWithWrongLengthsOf2010CostNothing) {
    for (const char* compression : {"none", "lz4"}) {
        const auto bag = small_bag({.compression = compression, .index_entry_bytes = 20}, 300);
        const auto read = read_bag(bag.file);
        EXPECT_EQ(read.messages, all_of(bag));
        EXPECT_EQ(read.losses_count, 0U);
    }
}

TEST(Rosbag, TopicInOuterHeaderAloneIsEnough) {
    const auto bag = small_bag({.has_inner_topics = false});
    EXPECT_EQ(read_bag(bag.file).messages, all_of(bag));
}

TEST(Rosbag, ConnectionsOfOneTopicAndTypeAreOneTopic) {
    BagWriter writer;
    const auto first = writer.connect("/tf", "tf2_msgs/TFMessage");
    const auto second = writer.connect("/tf", "tf2_msgs/TFMessage");
    const auto other = writer.connect("/tf", "tf/tfMessage");
    for (const auto connection : {first, second, other}) writer.write(connection, 1, "x");
    const auto read = read_bag(writer.finish().file);
    EXPECT_THAT(read.messages, SizeIs(3));
    EXPECT_THAT(read.topics, ElementsAre(RecordedTopic{"/tf", "tf2_msgs/TFMessage", MessageEncoding::kRos1},
                                         RecordedTopic{"/tf", "tf/tfMessage", MessageEncoding::kRos1}));
}

TEST(Rosbag, TypeWithoutNameIsToldByItsChecksum) {
    BagWriter writer;
    writer.write(writer.connect("/a", "*", "90c7ef2dc6895d81024acba2ac42f369"), 1, "x");
    writer.write(writer.connect("/b", "", "cd5e73d190d741a2f92e81eda573aca7"), 2, "x");
    writer.write(writer.connect("/c", "*", "12345678901234567890123456789012"), 3, "x");
    const auto topics = read_bag(writer.finish().file).topics;
    ASSERT_THAT(topics, SizeIs(3));
    EXPECT_EQ(topics[0].type, "sensor_msgs/LaserScan");
    EXPECT_EQ(topics[1].type, "nav_msgs/Odometry");
    EXPECT_EQ(topics[2].type, "");
}

TEST(Rosbag, MessagesOutsideOfChunksAreRead) {
    BagWriter writer;
    const auto connection = writer.connect("/scan", "sensor_msgs/LaserScan");
    writer.write(connection, 1, "in a chunk");
    writer.write_raw(BagWriter::message_record(connection, 2, "outside"));
    writer.write(connection, 3, "in a chunk again");
    const auto read = read_bag(writer.finish().file);
    EXPECT_THAT(read.messages, ElementsAre(ReadMessage{"/scan", 1, "in a chunk"}, ReadMessage{"/scan", 2, "outside"},
                                           ReadMessage{"/scan", 3, "in a chunk again"}));
    EXPECT_EQ(read.losses_count, 0U);
}

TEST(Rosbag, BytesBetweenChunksAreOneLossWithTheirPlace) {
    BagWriter writer({.compression = "lz4"});
    const auto connection = writer.connect("/scan", "sensor_msgs/LaserScan");
    writer.write(connection, 1, "before");
    writer.write_raw(std::string(100'000, 'x'));
    writer.write(connection, 2, "behind");
    const auto bag = writer.finish();
    const auto read = read_bag(bag.file);
    EXPECT_EQ(read.messages, all_of(bag));
    ASSERT_THAT(read.losses, SizeIs(1));
    EXPECT_EQ(read.losses[0].offset, bag.file.find("xxxx"));
    EXPECT_THAT(read.losses[0].reason, HasSubstr("100000 bytes"));
}

TEST(Rosbag, ConnectionsOfALostChunkAreFoundInAnIndexThatHasMoved) {
    auto bag = small_bag({.compression = "bz2"});
    const auto first = bag.messages.front();
    bag.file.erase(first.begin + 100, first.end - first.begin - 120); // with the connections that it describes
    std::vector<ReadMessage> wanted;
    for (const auto& message : bag.messages) {
        if (message.begin != first.begin) wanted.push_back(as_read(message));
    }
    EXPECT_EQ(read_bag(bag.file).messages, wanted);
}

TEST(Rosbag, MessageOfUnknownConnectionIsALoss) {
    BagWriter writer;
    writer.write(writer.connect("/scan", "sensor_msgs/LaserScan"), 1, "x");
    writer.write_raw(BagWriter::message_record(7, 2, "y"));
    const auto read = read_bag(writer.finish().file);
    EXPECT_THAT(read.messages, SizeIs(1));
    ASSERT_THAT(read.losses, SizeIs(1));
    EXPECT_THAT(read.losses[0].reason, HasSubstr("connection 7"));
}

TEST(Rosbag, LossesAreCountedButNotAllListed) {
    BagWriter writer;
    writer.write(writer.connect("/scan", "sensor_msgs/LaserScan"), 1, "x");
    for (int i = 0; i < 1000; ++i) writer.write_raw(BagWriter::message_record(7, 2, "y"));
    const auto read = read_bag(writer.finish().file);
    EXPECT_EQ(read.losses_count, 1000U);
    EXPECT_THAT(read.losses, SizeIs(kRecordingLossesListed));
}

TEST(Rosbag, ChunkThatDecompressesToMoreThanItSaysIsALossOfTheRest) {
    auto bag = small_bag({.compression = "bz2", .chunk_bytes = 1 << 20}, 100);
    // The field size=... of the chunk's header: state 300 bytes only.
    const auto at = bag.file.find("size=") + 5;
    bag.file.replace(at, 4, std::string("\x2c\x01\0\0", 4));
    const auto read = read_bag(bag.file);
    EXPECT_THAT(read.messages, testing::Not(IsEmpty()));
    EXPECT_LT(read.messages.size(), 10U);
    EXPECT_TRUE(has_in_order(all_of(bag), read.messages));
    EXPECT_THAT(read.losses.at(0).reason, HasSubstr("larger than 300 bytes"));
}

TEST(Rosbag, HugeLengthsAllocateNothing) {
    BagWriter writer;
    const auto connection = writer.connect("/scan", "sensor_msgs/LaserScan");
    writer.write(connection, 1, "before");
    std::string record = BagWriter::message_record(connection, 2, "");
    record.replace(record.size() - 4, 4, 4, '\xff');
    writer.write_raw(record);
    writer.write(connection, 3, "behind");
    const auto read = read_bag(writer.finish().file);
    EXPECT_THAT(read.messages, SizeIs(2));
    EXPECT_EQ(read.losses_count, 1U);
}

TEST(Rosbag, OtherVersionsAreRefusedWithWhatConvertsThem) {
    const auto old = error_of_bag("#ROSRECORD V1.2\n----");
    EXPECT_EQ(old.code, Errc::kUnsupportedVersion);
    EXPECT_THAT(old.message, HasSubstr("a.bag: a ROS bag of format 1.2"));
    EXPECT_THAT(old.message, HasSubstr("`rosbag fix OLD.bag NEW.bag` of ROS Kinetic or earlier"));
    for (const char* line : {"#ROSLOG V1.1\n", "#ROSRECORD V1.1\n", "#ROSBAG V3.0\n"}) {
        const auto other = error_of_bag(line);
        EXPECT_EQ(other.code, Errc::kUnsupportedVersion);
        EXPECT_THAT(other.message, HasSubstr("'" + std::string(line, std::strlen(line) - 1) + "'"));
    }
    EXPECT_EQ(error_of_bag("#ROSBAG").code, Errc::kMalformed);
}

TEST(Rosbag, EncryptedBagIsRefused) {
    std::string header;
    testing_support::append_counted(header, "op=\x03");
    testing_support::append_counted(header, "index_pos=" + std::string(8, '\0'));
    testing_support::append_counted(header, "encryptor=rosbag/AesCbcEncryptor");
    std::string file = "#ROSBAG V2.0\n";
    testing_support::append_counted(file, header);
    testing_support::append_counted(file, "");
    const auto error = error_of_bag(file);
    EXPECT_EQ(error.code, Errc::kUnsupportedVersion);
    EXPECT_THAT(error.message, HasSubstr("rosbag/AesCbcEncryptor"));
}

} // namespace
} // namespace scanloom::robot
