#include "common/scan/limits.hpp"
#include "common/wire/log_codec.hpp"
#include "tests/integration/ingest_fixture.hpp"
#include "tests/support/log_reading.hpp"

#include <boost/endian/conversion.hpp>
#include <zstd.h>

#include <atomic>
#include <limits>
#include <random>

/// Robots that send invalid data: each gets a specific error, and other robots are not disturbed.
namespace scanloom::ingest {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::string length_prefix(std::uint32_t bytes) {
    unsigned char prefix[4];
    boost::endian::store_big_u32(prefix, bytes);
    return {reinterpret_cast<const char*>(prefix), 4};
}

std::string frame_around(std::string_view body) {
    std::string frame;
    wire::append_checked_frame(frame, body);
    return frame;
}

/// As after a bit error on the link.
std::string damaged(std::string frame) {
    frame[frame.size() / 2] = static_cast<char>(frame[frame.size() / 2] ^ 1);
    return frame;
}

std::string batch_with(void (*spoil)(Scan&)) {
    auto scans = random_scans(1, 1, 3);
    spoil(scans[2]);
    return frame_of(wire::ScanBatch{scans});
}

wire::Hello hello_with(void (*change)(wire::Hello&)) {
    auto changed = hello("faulty");
    change(changed);
    return changed;
}

/// The frames of a robot, and the error it gets.
struct Fault {
    std::string bytes;
    Errc code;
    std::string message; // its beginning
    bool retryable = false;
};

std::vector<Fault> faults_before_the_hello() {
    return {
        {length_prefix(wire::kFrameBytesMaxBeforeHello + 1), Errc::kTooLarge,
         "a frame announces 16385 bytes, at most 16384 are allowed before the hello; send the hello first"},
        {length_prefix(0xFFFFFFFF), Errc::kTooLarge, "a frame announces 4294967295 bytes"},
        {length_prefix(0), Errc::kMalformed, "a frame of 0 bytes"},
        {frame_around("garbage that is no protobuf"), Errc::kMalformed, "33 bytes that are not a scanloom.v1.Frame"},
        {frame_around("\xfa\x01\x02hi"), Errc::kMalformed, "a frame without a body"},
        {frame_of(wire::Ping{1}), Errc::kMalformed, "the first frame is a ping; a hello is expected"},
        {frame_of(small_laser()), Errc::kMalformed, "the first frame is a sensor_description; a hello"},
        {frame_of(hello_with([](auto& h) { h.protocol_version = 9; })), Errc::kUnsupportedVersion,
         "hello.protocol_version is 9"},
        {frame_of(hello_with([](auto& h) { h.robot = "no good"; })), Errc::kInvalidField, "hello.robot is not"},
        {frame_of(hello_with([](auto& h) { h.session = "../x"; })), Errc::kInvalidField, "hello.session is not"},
        {frame_of(hello_with([](auto& h) {
             h.session = "nowhere";
             h.create.reset();
         })),
         Errc::kNotFound, "hello.session is 'nowhere', which does not exist"},
        {frame_of(hello_with([](auto& h) { h.create->cell_size = 0.1; })), Errc::kConflict,
         "hello.create: the session exists with cell_size 0.05, cell_size 0.1 was asked for"},
    };
}

std::vector<Fault> faults_after_the_hello() {
    const auto laser = frame_of(small_laser());
    return {
        {length_prefix(wire::kFrameBytesMax + 1), Errc::kTooLarge,
         "a frame announces 1048577 bytes, at most 1048576 are allowed here; send fewer scans per batch"},
        {frame_around("garbage that is no protobuf"), Errc::kMalformed, "33 bytes that are not a scanloom.v1.Frame"},
        {damaged(frame_of(small_laser())), Errc::kDamaged, "a frame of 54 bytes was damaged in transmission", true},
        {frame_of(hello("faulty")), Errc::kMalformed, "a hello frame is not for the server"},
        {frame_of(wire::Ack{}), Errc::kMalformed, "a ack frame is not for the server"},
        {laser + batch_with([](Scan& s) { s.pose->x = kNan; }), Errc::kInvalidField,
         "scan_batch.scans[2].pose.x is nan"},
        {laser + batch_with([](Scan& s) { s.pose->yaw = std::numeric_limits<double>::infinity(); }),
         Errc::kInvalidField, "scan_batch.scans[2].pose.yaw is inf"},
        {laser + batch_with([](Scan& s) { s.ranges.clear(); }), Errc::kInvalidField,
         "scan_batch.scans[2].ranges is empty"},
        {laser + batch_with([](Scan& s) { s.ranges.assign(100'000, 1); }), Errc::kTooLarge,
         "scan_batch.scans[2].ranges has 100000 beams"},
        {laser + batch_with([](Scan& s) { s.sensor = 9; }), Errc::kInvalidField,
         "scan_batch.scans[2].sensor is 9, which was not described"},
        {laser + batch_with([](Scan& s) { s.ranges.assign(90, 1); }), Errc::kInvalidField,
         "scan_batch.scans[2].ranges has 90 beams, which span"},
        {laser + batch_with([](Scan& s) { s.seq = 1000; }), Errc::kOutOfOrder, "scan_batch.scans[2].seq is 1000, 3 is",
         true},
    };
}

/// Frames that a server ignores, more than a socket's buffers can hold: closing the socket with unread frames would
/// reset the link.
std::string many_pongs() {
    std::string frames;
    while (frames.size() < std::size_t{8} << 20) wire::encode(wire::Pong{1}, frames);
    return frames;
}

void expect_fault_refused(std::uint16_t port, bool after_hello, const Fault& fault, bool talks_on) {
    SCOPED_TRACE(fault.message);
    RobotSocket robot(port);
    if (after_hello) {
        // Scans before a fault are kept: each case has its own robot, so that seq 1 is always the next.
        static std::atomic<int> robots = 0;
        robot.send(hello("faulty" + std::to_string(++robots)));
        robot.receive_kind<wire::Welcome>();
    }
    robot.send_bytes(fault.bytes);
    static const std::string more = many_pongs();
    if (talks_on) robot.send_bytes(more);
    expect_refused(robot, fault.code, fault.retryable, fault.message);
}

void expect_all_refused(std::uint16_t port, bool talks_on) {
    for (const auto& fault : faults_before_the_hello()) expect_fault_refused(port, false, fault, talks_on);
    for (const auto& fault : faults_after_the_hello()) expect_fault_refused(port, true, fault, talks_on);
}

TEST_F(IngestTest, EachFaultyRobotGetsASpecificError) {
    start();
    welcomed(port(), hello("first")); // creates the session
    expect_all_refused(port(), false);
}

TEST_F(IngestTest, AFaultyRobotThatKeepsSendingCanReadItsError) {
    start();
    welcomed(port(), hello("first"));
    expect_all_refused(port(), true);
}

TEST_F(IngestTest, AFaultyRobotDoesNotDisturbOtherRobots) {
    auto& ingest = start();
    const auto healthy = welcomed(port(), hello("healthy"));
    healthy->send(small_laser());
    std::thread streaming([&] { stream(*healthy, 1, 1, 3000); });
    expect_all_refused(port(), false);
    streaming.join();
    healthy->send(wire::Ping{5});
    EXPECT_EQ(healthy->receive_kind<wire::Pong>().nonce, 5U);
    EXPECT_EQ(ingest.snapshot("lab")->robots.at(0).scan_count, 3000U);
}

TEST_F(IngestTest, AnInvalidCellSizeIsReportedAndCreatesNoSession) {
    auto& ingest = start();
    for (const double cell_size : {0.0, -0.05, 1e-9, 1e9, kNan}) {
        RobotSocket robot(port());
        auto absurd = hello("r");
        absurd.create->cell_size = cell_size;
        robot.send(absurd);
        expect_refused(robot, Errc::kInvalidField, false, "hello.create.cell_size is ");
    }
    EXPECT_TRUE(ingest.sessions().list().empty());
    EXPECT_TRUE(log_.sessions()->empty());
}

TEST_F(IngestTest, ADamagedSessionIsReportedAndNotRecreated) {
    const auto id = log_.create_session(wire::encode_session({"broken", 0.0, {}})).value();
    ASSERT_TRUE(store::append_and_wait(log_, id, 1, {"no entry"}));
    start();
    for (const bool create : {true, false}) {
        RobotSocket robot(port());
        auto wanted = hello("r", "broken");
        if (!create) wanted.create.reset();
        robot.send(wanted);
        expect_refused(robot, Errc::kConflict, false, "hello.session is 'broken', whose log is damaged");
    }
    welcomed(port(), hello("r", "whole"));
}

TEST_F(IngestTest, ALinkThatEndsInsideAFrameLosesOnlyThatFrame) {
    auto& ingest = start();
    const std::string batch = frame_of(wire::ScanBatch{random_scans(1, 11, 5)});
    {
        const auto robot = welcomed(port(), hello("r"));
        robot->send(small_laser());
        stream(*robot, 1, 1, 10);
        robot->send_bytes(std::string_view(batch).substr(0, batch.size() - 1));
        robot->finish_sending();
        while (robot->receive()) {
        }
    }
    {
        RobotSocket robot(port());
        robot.send(hello("r"));
        EXPECT_EQ(robot.receive_kind<wire::Welcome>().last_durable_seq, 10U);
        robot.send_bytes(std::string_view(batch).substr(0, 2));
        robot.reset();
    }
    const auto robot = welcomed(port(), hello("r"));
    stream(*robot, 1, 11, 20);
    EXPECT_EQ(ingest.snapshot("lab")->robots.at(0).scan_count, 20U);
}

TEST_F(IngestTest, RandomBytesEndTheLinkWithOrWithoutAnError) {
    start();
    std::mt19937 random(21);
    for (int round = 0; round < 200; ++round) {
        RobotSocket robot(port());
        std::string bytes(1 + random() % 300, '\0');
        for (char& byte : bytes) byte = static_cast<char>(random());
        if (round % 2 == 0) bytes = frame_around(bytes);
        robot.send_bytes(bytes);
        robot.finish_sending();
        while (const auto message = robot.receive()) EXPECT_TRUE(std::holds_alternative<wire::LinkError>(*message));
    }
    welcomed(port(), hello("r"));
}

TEST_F(IngestTest, ExactlyTheCreditMayBeInFlight) {
    const wire::Message batch = wire::ScanBatch{{random_scan(1, 1)}};
    IngestConfig config;
    config.link.credit_bytes = 3 * frame_of(batch).size();
    start(config);
    const auto robot = welcomed(port(), hello("r"));
    robot->send(small_laser());
    robot->send(batch);
    robot->wait_for_ack(1);
    log_.hold_completions();
    for (std::uint64_t seq = 2; seq <= 4; ++seq) robot->send(wire::ScanBatch{{random_scan(1, seq)}});
    robot->send(wire::Ping{1});
    EXPECT_EQ(robot->receive_kind<wire::Pong>().nonce, 1U) << "all three are within the credit";
    robot->send(wire::ScanBatch{{random_scan(1, 5)}});
    expect_refused(*robot, Errc::kCreditExceeded, false, std::to_string(4 * frame_of(batch).size()) + " bytes of scan");
    log_.release_completions();
    RobotSocket again(port());
    again.send(hello("r"));
    EXPECT_EQ(again.receive_kind<wire::Welcome>().last_durable_seq, 4U);
}

TEST_F(IngestTest, CompressedScansUseCreditOfTheirUncompressedSize) {
    const wire::Message batch = wire::ScanBatch{{random_scan(1, 1)}};
    const auto compressed = [](std::uint64_t seq) {
        const std::string frame = frame_of(wire::ScanBatch{{random_scan(1, seq)}});
        std::string zstd(ZSTD_compressBound(frame.size()), '\0');
        zstd.resize(ZSTD_compress(zstd.data(), zstd.size(), frame.data() + wire::kLengthPrefixBytes,
                                  frame.size() - wire::kLengthPrefixBytes, 1));
        return wire::CompressedScanBatch{static_cast<std::uint32_t>(frame.size() - wire::kLengthPrefixBytes), zstd};
    };
    IngestConfig config;
    config.link.credit_bytes = frame_of(batch).size() * 5 / 2;
    start(config);
    const auto robot = welcomed(port(), hello("r"));
    robot->send(small_laser());
    robot->send(compressed(1));
    while (robot->receive_kind<wire::Ack>().durable_seq < 1) { // the first ack may be for the description
    }
    log_.hold_completions();
    for (std::uint64_t seq = 2; seq <= 4; ++seq) robot->send(compressed(seq));
    EXPECT_EQ(farewell_to(*robot).error.code, Errc::kCreditExceeded);
    log_.release_completions();
}

TEST_F(IngestTest, AnInvalidCompressedBatchEndsTheLinkWithAnError) {
    start();
    for (const auto& [bad, text] :
         {std::pair{wire::CompressedScanBatch{1U << 30, "x"}, "compressed_scan_batch.size is 1073741824"},
          std::pair{wire::CompressedScanBatch{100, "x"}, "no Zstandard frame"}}) {
        const auto robot = welcomed(port(), hello("r"));
        robot->send(bad);
        EXPECT_THAT(farewell_to(*robot).error.message, testing::HasSubstr(text));
    }
}

TEST_F(IngestTest, SensorDescriptionsNeedNoCreditButAreLimited) {
    const wire::Message batch = wire::ScanBatch{{random_scan(1, 1)}};
    IngestConfig config;
    config.link.credit_bytes = frame_of(batch).size();
    start(config);
    const auto robot = welcomed(port(), hello("r"));
    robot->send(small_laser());
    robot->send(wire::Ping{1});
    robot->receive_kind<wire::Pong>();
    log_.hold_completions();
    Sensor large = small_laser();
    large.id = 3;
    large.angles = ExplicitAngles(kBeamsMax, 0.5);
    for (std::uint64_t n = 2; n <= 65; ++n) { // as many as a robot can have, and a scan within the credit
        large.name = std::to_string(n);
        robot->send(large);
        if (n == 30) robot->send(batch);
    }
    robot->send(wire::Ping{2});
    EXPECT_EQ(robot->receive_kind<wire::Pong>().nonce, 2U);
    for (int n = 0; n < 100; ++n) robot->send(large);
    const auto refused = farewell_to(*robot);
    EXPECT_EQ(refused.error.code, Errc::kCreditExceeded);
    EXPECT_THAT(refused.error.message, testing::HasSubstr("bytes of sensor descriptions are under way"));
    log_.release_completions();
}

} // namespace
} // namespace scanloom::ingest
