#include "server/session/checkpoint.hpp"

#include "server/mapping/digest.hpp"
#include "tests/unit/server/session/session_fixture.hpp"

#include <map>

/// Parts of a checkpoint: written, merged, damaged, read.
namespace scanloom::session {
namespace {

using testing::HasSubstr;

using Parts = std::map<std::string, std::string>; // as the store keeps them

void merge(Parts& parts, std::vector<store::CheckpointPart> newer) {
    for (auto& part : newer) parts[part.key] = std::move(part.value);
}

std::vector<LogEntry> log_of_two_robots(std::size_t scans) {
    Sensor second = small_laser();
    second.id = 40;
    std::vector<LogEntry> log{RobotJoined{0, "a"}, SensorDescribed{0, small_laser()}, SensorDescribed{0, second},
                              RobotJoined{1, "b"}, SensorDescribed{1, small_laser()}};
    for (std::uint64_t seq = 1; seq <= scans; ++seq) {
        for (RobotIndex robot = 0; robot < 2; ++robot) log.push_back(ScanTaken{robot, random_scan(robot, seq)});
    }
    return log;
}

void fold(mapping::Projection& projection, const std::vector<LogEntry>& log, std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) ASSERT_TRUE(projection.fold(log[n]));
}

std::vector<store::CheckpointPart> parts_of(mapping::Projection& projection, Revision since) {
    return checkpoint_parts(projection.snapshot(), projection.state(), since);
}

Result<mapping::Projection> read(const Parts& parts) {
    CheckpointReader reader{mapping::MapConfig{}};
    for (const auto& [key, value] : parts) {
        if (auto added = reader.add(key, value); !added) return added.error();
    }
    return std::move(reader).finish();
}

void expect_same(mapping::Projection& a, mapping::Projection& b) {
    const auto left = a.snapshot();
    const auto right = b.snapshot();
    EXPECT_EQ(left.revision, right.revision);
    EXPECT_EQ(left.bounds, right.bounds);
    EXPECT_EQ(mapping::digest_of(left.occupancy), mapping::digest_of(right.occupancy));
    ASSERT_EQ(left.robots.size(), right.robots.size());
    for (RobotIndex n = 0; n < left.robots.size(); ++n) {
        const auto& l = left.robots[n];
        const auto& r = right.robots[n];
        EXPECT_EQ(std::tie(l.name, l.last_seq, l.scan_count, l.stamp, l.pose),
                  std::tie(r.name, r.last_seq, r.scan_count, r.stamp, r.pose));
        EXPECT_EQ(a.sensors_of(n), b.sensors_of(n));
        ASSERT_EQ(l.trajectory.size(), r.trajectory.size());
        for (std::size_t i = 0; i < l.trajectory.size(); ++i) ASSERT_EQ(l.trajectory[i], r.trajectory[i]);
    }
}

TEST(Checkpoint, ReadBackItIsTheSameProjection) {
    const auto log = log_of_two_robots(700); // more than one block of trajectory
    mapping::Projection projection{mapping::MapConfig{}};
    fold(projection, log, 0, log.size());
    Parts parts;
    merge(parts, parts_of(projection, 0));
    auto again = read(parts).value();
    expect_same(projection, again);
    Parts parts_again;
    merge(parts_again, parts_of(again, 0));
    EXPECT_EQ(parts, parts_again);
}

TEST(Checkpoint, OfNothingIsABlankProjection) {
    auto projection = read({}).value();
    EXPECT_EQ(projection.revision(), 0U);
    EXPECT_TRUE(projection.snapshot().robots.empty());
}

TEST(Checkpoint, IncrementalOnesMergeToAFullOne) {
    const auto log = log_of_two_robots(700);
    mapping::Projection projection{mapping::MapConfig{}};
    Parts merged;
    Revision since = 0;
    std::mt19937 random(9);
    for (std::size_t at = 0; at < log.size();) {
        const std::size_t end = std::min<std::size_t>(log.size(), at + 1 + random() % 250);
        fold(projection, log, at, end);
        at = end;
        merge(merged, parts_of(projection, since));
        since = projection.revision();
    }
    Parts full;
    merge(full, parts_of(projection, 0));
    EXPECT_EQ(merged, full);
}

TEST(Checkpoint, IncrementalOnesHoldOnlyTheChunksThatChanged) {
    mapping::Projection projection{mapping::MapConfig{}};
    fold(projection, log_of_two_robots(20), 0, 45);
    const auto full = parts_of(projection, 0).size();
    const Revision since = projection.revision();
    Scan scan = random_scan(0, 21);
    scan.ranges = {100}; // one short beam: at most the chunks around a corner
    ASSERT_TRUE(projection.fold(ScanTaken{0, scan}));
    const auto parts = parts_of(projection, since);
    const auto chunks = std::count_if(parts.begin(), parts.end(),
                                      [](const auto& part) { return part.key.starts_with("weave/occupancy/"); });
    EXPECT_GE(chunks, 1);
    EXPECT_LE(chunks, 4);
    EXPECT_LT(parts.size(), full);
}

TEST(Checkpoint, EveryPartCutShortIsReported) {
    mapping::Projection projection{mapping::MapConfig{}};
    fold(projection, log_of_two_robots(30), 0, 65);
    Parts parts;
    merge(parts, parts_of(projection, 0));
    for (const auto& [key, value] : parts) {
        const bool is_robot = key.starts_with("robot/"); // its name is whatever follows the numbers
        const std::size_t shortest = is_robot ? 16 : value.size();
        for (const std::size_t kept : {std::size_t{0}, std::size_t{7}, shortest / 2, shortest - 1}) {
            Parts damaged = parts;
            damaged[key].resize(kept);
            const auto refused = read(damaged);
            ASSERT_FALSE(refused) << key << " cut to " << kept;
            EXPECT_EQ(refused.error().code, Errc::kMalformed);
        }
    }
}

TEST(Checkpoint, PosesThatAreMissingAreReported) {
    mapping::Projection projection{mapping::MapConfig{}};
    fold(projection, log_of_two_robots(600), 0, 1205);
    Parts parts;
    merge(parts, parts_of(projection, 0));
    for (const char* block : {"track/00000000/00000000", "track/00000001/00000001"}) {
        Parts missing = parts;
        ASSERT_EQ(missing.erase(block), 1U);
        ASSERT_FALSE(read(missing)) << block;
    }
    parts["track/00000000/00000001"].resize(40); // one point of 40 bytes: no cut is seen in the part itself
    const auto refused = read(parts);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("513 poses of robot 'a', which took 600 scans"));
}

TEST(Checkpoint, PartsThatCannotBeAreReportedByTheirKey) {
    mapping::Projection projection{mapping::MapConfig{}};
    fold(projection, log_of_two_robots(3), 0, 11);
    Parts parts;
    merge(parts, parts_of(projection, 0));
    const std::string sensor = parts.at("sensor/00000000/00000002");
    const std::string scan = wire::encode_entry(ScanTaken{0, random_scan(0, 1)});
    const std::string point(40, '\0');
    const std::pair<std::string, std::string> kImpossible[] = {
        {"robot/00000003", std::string(17, 'x')},
        {"robot/", ""},
        {"sensor/00000002/00000000", sensor},
        {"sensor/00000001/00000009", scan},
        {"sensor/", ""},
        {"track/00000002/00000000", point},
        {"track/xyz/00000000", point},
        {"track", ""},
        {"weave/occupancy/00000000", ""},
        {"weave/occupancy/0/0/0", ""},
        {"weave/", ""},
        {"zebra", ""},
        {"", ""},
    };
    for (const auto& [key, value] : kImpossible) {
        Parts damaged = parts;
        damaged[key] = value;
        const auto refused = read(damaged);
        ASSERT_FALSE(refused) << key;
        EXPECT_EQ(refused.error().message, "checkpoint part '" + key + "' is damaged");
    }
}

TEST(Checkpoint, OfAnotherWeavingVersionIsReported) {
    mapping::Projection projection{mapping::MapConfig{}};
    Parts parts;
    merge(parts, parts_of(projection, 0));
    parts["head"][0] = static_cast<char>(mapping::kWeavingVersion + 1);
    const auto refused = read(parts);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::kUnsupportedVersion);
    EXPECT_THAT(refused.error().message, HasSubstr("woven by version 2"));
}

} // namespace
} // namespace scanloom::session
