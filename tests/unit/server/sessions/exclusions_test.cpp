#include "server/sessions/log_readers.hpp"
#include "server/sessions/replay_job.hpp"
#include "server/sessions/session_check.hpp"
#include "server/sessions/stored_trajectories.hpp"
#include "tests/unit/server/sessions/registry_fixture.hpp"

#include <random>

/// The maps of a session with excluded scans equal those of a session without these scans.
namespace scanloom::sessions {
namespace {

using testing::HasSubstr;

bool is_in(const ScanTaken& taken, const std::variant<StampRange, SeqRange>& range) {
    if (const auto* seqs = std::get_if<SeqRange>(&range)) {
        return taken.scan.seq >= seqs->from && taken.scan.seq <= seqs->to;
    }
    const auto& stamps = std::get<StampRange>(range);
    return taken.scan.stamp >= stamps.from && taken.scan.stamp <= stamps.to;
}

/// Returns whether an exclusion after the entry covers its scan and is not lifted at the end of the log.
bool is_excluded(const std::vector<LogEntry>& log, std::size_t n) {
    const auto* taken = std::get_if<ScanTaken>(&log[n]);
    for (std::size_t later = n + 1; taken != nullptr && later < log.size(); ++later) {
        const auto* excluded = std::get_if<ScansExcluded>(&log[later]);
        if (excluded == nullptr || excluded->robot != taken->robot || !is_in(*taken, excluded->scans)) continue;
        const bool is_lifted = std::ranges::find(log, LogEntry(ExclusionLifted{excluded->id})) != log.end();
        if (!is_lifted) return true;
    }
    return false;
}

/// Returns the log without excluded scans and exclusions.
std::vector<LogEntry> kept_of(const std::vector<LogEntry>& log) {
    std::vector<LogEntry> kept;
    for (std::size_t n = 0; n < log.size(); ++n) {
        const bool is_exclusion =
            std::holds_alternative<ScansExcluded>(log[n]) || std::holds_alternative<ExclusionLifted>(log[n]);
        if (!is_exclusion && !is_excluded(log, n)) kept.push_back(log[n]);
    }
    return kept;
}

/// Returns the log of a session that never had the excluded scans: the sequence numbers are consecutive.
std::vector<LogEntry> log_without_excluded(const std::vector<LogEntry>& log) {
    auto kept = kept_of(log);
    std::map<RobotIndex, std::uint64_t> seqs;
    for (auto& entry : kept) {
        if (auto* taken = std::get_if<ScanTaken>(&entry)) taken->scan.seq = ++seqs[taken->robot];
    }
    return kept;
}

mapping::Projection projection_of(const std::vector<LogEntry>& log, const mapping::MapConfig& config) {
    mapping::Projection projection(config);
    for (const auto& entry : log) projection.apply(entry).value();
    return projection;
}

class ExclusionsTest : public SessionRegistryTest {
protected:
    ~ExclusionsTest() override { registry_->drain(); }

    void create(double max_jump = 0.0) {
        SessionOptions options;
        options.max_jump = max_jump;
        const auto session = registry_->create("lab", options).value();
        id_ = session->info().id;
        config_ = session->info().config;
    }

    [[nodiscard]] std::shared_ptr<Session> session() { return registry_->load("lab").value(); }

    /// Streams the robot's next scans.
    void stream(const std::string& robot, std::uint64_t count) {
        const auto link = std::make_shared<AwaitedLink>();
        const auto held = session();
        const auto last = join_and_wait(*held, robot, link).value().last_durable_seq;
        held->submit(link, small_laser(), 0);
        for (std::uint64_t seq = last + 1; seq <= last + count; ++seq) held->submit(link, {random_scan(7, seq)}, 0);
        link->wait_for_seq(last + count);
        held->leave(link);
    }

    /// Returns the log's entries; revision n is at index n - 1.
    [[nodiscard]] std::vector<LogEntry> log() {
        std::vector<LogEntry> entries;
        for (const auto& bytes : store::entries_after(log_, id_, 0).value()) {
            entries.push_back(wire::decode_entry(bytes).value());
        }
        return entries;
    }

    /// Compares maps, trajectories and captures.
    void expect_that_excluded_scans_leave_no_trace() {
        const auto entries = log();
        auto expected = projection_of(log_without_excluded(entries), config_);
        const auto wanted = expected.snapshot();
        const auto maps = session()->snapshot();
        ASSERT_EQ(maps->revision, entries.size());
        EXPECT_EQ(testing_support::digests_of(*maps), testing_support::digests_of(wanted));
        EXPECT_EQ(maps->bounds, wanted.bounds);
        std::uint64_t excluded = 0;
        for (std::size_t n = 0; n < entries.size(); ++n) excluded += is_excluded(entries, n) ? 1 : 0;
        const auto old = read_old_paths(log_, id_, *maps, 0, [] { return true; }).value();
        for (RobotIndex robot = 0; robot < maps->robots.size(); ++robot) {
            const auto& actual = maps->robots[robot];
            const auto& wanted_robot = wanted.robots[robot];
            EXPECT_EQ(actual.scan_count, wanted_robot.scan_count);
            EXPECT_EQ(std::tie(actual.stamp, actual.pose), std::tie(wanted_robot.stamp, wanted_robot.pose));
            EXPECT_EQ(actual.last_seq, actual.scan_count + actual.jumps + actual.excluded);
            excluded -= actual.excluded;
            ASSERT_EQ(actual.trajectory.size(), wanted_robot.trajectory.size());
            for (std::size_t n = 0; n < wanted_robot.trajectory.size(); ++n) {
                const auto& point = n < actual.trajectory.begin() ? old.robots[robot][n] : actual.trajectory[n];
                ASSERT_EQ(point.pose, wanted_robot.trajectory[n].pose) << robot << ", " << n;
            }
        }
        EXPECT_EQ(excluded, 0U) << "the sum of the robots' counts is the number of excluded scans";
        EXPECT_EQ(captures(scan_filter_of(session()->info())), captures_of(kept_of(entries)));
    }

    /// Stamp and points of each capture. Revisions are omitted because they differ.
    using SeenThings = std::vector<std::pair<double, std::vector<PointMm>>>;

    [[nodiscard]] SeenThings captures(ScanFilter filter) {
        landmarks::SessionCaptures cut(std::move(filter));
        SeenThings found;
        const auto visit = [&](const landmarks::RobotCapture& one) -> Result<> {
            found.emplace_back(one.capture.stamp, one.capture.points);
            return {};
        };
        read_captures(log_, id_, cut, log().size(), {}, visit, [](Revision) { return Result<>(); }).value();
        return found;
    }

    [[nodiscard]] SeenThings captures_of(const std::vector<LogEntry>& entries) const {
        landmarks::SessionCaptures cut(ScanFilter(config_.max_jump));
        SeenThings found;
        for (const auto& entry : entries) {
            if (const auto ended = cut.add(entry)) found.emplace_back(ended->capture.stamp, ended->capture.points);
        }
        return found;
    }

    void restart_or_evict(std::mt19937& random) {
        static_cast<void>(session()); // a registry must not be destroyed while it reads a session
        switch (random() % 4) {
        case 0: registry_->drain(); [[fallthrough]]; // writes a checkpoint
        case 1:                                      // without a checkpoint, as after a crash
            wait_for_posted_tasks();                 // an eviction may have posted some to the registry
            restart();
            break;
        case 2:
            clock_ = clock_.load() + std::chrono::hours(1);
            registry_->tidy();
            break;
        default: break;
        }
    }

    store::SessionId id_ = 0;
    mapping::MapConfig config_;
};

class RandomExclusionsTest : public ExclusionsTest, public testing::WithParamInterface<unsigned> {};

TEST_P(RandomExclusionsTest, ExcludedScansLeaveNoTraceInMapsTrajectoriesAndCaptures) {
    std::mt19937 random(GetParam());
    create(random() % 2 == 0 ? 0.0 : 1.5);
    const auto number = [&](std::uint64_t below) { return random() % below; };
    for (int step = 0; step < 8; ++step) {
        for (const auto* robot : {"a", "b"}) stream(robot, 1 + number(12));
        const auto robot = static_cast<RobotIndex>(number(2));
        if (number(2) == 0) {
            const std::uint64_t from = 1 + number(40);
            ASSERT_TRUE(registry_->exclude("lab", robot, SeqRange{from, from + number(9)}));
        } else {
            const double from = static_cast<double>(number(40)) * 0.1; // stamps are 0.1 s per sequence number
            const double length = static_cast<double>(number(20)) * 0.1;
            ASSERT_TRUE(registry_->exclude("lab", robot, StampRange{from, from + length}));
        }
        restart_or_evict(random);
        const auto& all = session()->info().exclusions->all();
        const auto& one = all[number(all.size())];
        if (number(3) == 0) {
            EXPECT_EQ(registry_->lift_exclusion("lab", one.excluded.id).has_value(), one.lifted == 0);
        }
        restart_or_evict(random);
        expect_that_excluded_scans_leave_no_trace();
    }
    const auto stored = log_.sessions().value().at(0);
    registry_->drain();
    EXPECT_EQ(check_session(log_, stored, CheckDepth::kMaps, [](std::size_t) { return Result<>(); }).value().damage,
              std::nullopt);
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomExclusionsTest, testing::Range(1U, 13U));

TEST_F(ExclusionsTest, KeepTheRobotsSequenceNumbers) {
    create();
    stream("a", 10);
    const auto link = std::make_shared<AwaitedLink>();
    ASSERT_TRUE(join_and_wait(*session(), "a", link));
    ASSERT_TRUE(registry_->exclude("lab", 0, SeqRange{1, 10}));
    EXPECT_EQ(link->wait_for_failure().code, Errc::kShuttingDown);
    EXPECT_EQ(join_and_wait(*session(), "a", std::make_shared<AwaitedLink>()).value().last_durable_seq, 10U);
    EXPECT_EQ(session()->snapshot()->robots.at(0).excluded, 10U);
    stream("a", 5);
    expect_that_excluded_scans_leave_no_trace();
}

TEST_F(ExclusionsTest, DoNotAffectMapsOfEarlierRevisions) {
    create();
    stream("a", 12);
    const auto exclusion = registry_->exclude("lab", 0, SeqRange{3, 9}).value();
    stream("a", 6);
    ASSERT_TRUE(registry_->lift_exclusion("lab", exclusion.excluded.id));
    ASSERT_TRUE(registry_->exclude("lab", 0, SeqRange{11, 14}));
    const auto entries = log();
    limits::MemoryBudget budget(1 << 20);
    const auto info = session()->info();
    // Compares a replay job that has all exclusions and a job that was started before there were any.
    for (const bool is_known : {true, false}) {
        SessionInfo of = info;
        if (!is_known) of.exclusions = no_exclusions();
        for (Revision until = 1; until <= entries.size(); ++until) {
            ReplayJob job(of, {config_, {.revision = until}}, until);
            while (job.run(log_, budget)) {
            }
            auto expected = projection_of(log_without_excluded({entries.begin(), entries.begin() + until}), config_);
            ASSERT_TRUE(job.maps()) << job.progress().error->message;
            ASSERT_EQ(testing_support::digests_of(*job.maps()), testing_support::digests_of(expected.snapshot()))
                << until;
            ASSERT_EQ(job.maps()->revision, until);
        }
    }
    EXPECT_EQ(budget.free(), budget.total());
}

TEST_F(ExclusionsTest, ExcludedWrongStampDoesNotEndReplay) {
    create();
    stream("a", 4);
    const auto link = std::make_shared<AwaitedLink>();
    ASSERT_TRUE(join_and_wait(*session(), "b", link));
    session()->submit(link, small_laser(), 0);
    Scan late = random_scan(8, 1);
    late.stamp = 1e6;
    session()->submit(link, {late}, 0);
    link->wait_for_seq(1);
    stream("a", 8);
    limits::MemoryBudget budget(1 << 20);
    const auto end_of = [&] {
        ReplayJob job(session()->info(), {config_, {.stamp = 1000.0}}, log().size());
        while (job.run(log_, budget)) {
        }
        return job.maps()->robots.at(0).last_seq;
    };
    EXPECT_EQ(end_of(), 4U);
    ASSERT_TRUE(registry_->exclude("lab", 1, SeqRange{1, 1}));
    EXPECT_EQ(end_of(), 12U);
}

TEST_F(ExclusionsTest, DoNotLoadTheSession) {
    create();
    stream("a", 20);
    registry_->drain();
    restart(1); // the memory budget is too small for the session's maps
    clock_ = clock_.load() + std::chrono::hours(1);
    ASSERT_FALSE(registry_->find("lab"));
    ASSERT_TRUE(registry_->exclude("lab", 0, SeqRange{1, 20})) << "exclusion must not load the session";
    const auto facts = registry_->listed("lab")->summary.facts;
    EXPECT_EQ(facts->revision, log().size());
    EXPECT_EQ(facts->exclusions->count_in_effect(), 1U);
    ASSERT_TRUE(registry_->lift_exclusion("lab", 1));
    EXPECT_EQ(registry_->info("lab")->exclusions->count_in_effect(), 0U);
}

TEST_F(ExclusionsTest, ApplyToReplayJobsThatFollowTheSession) {
    create();
    stream("a", 12);
    limits::MemoryBudget budget(1 << 20);
    ReplayJob job(session()->info(), {config_, {}}, log().size());
    while (job.run(log_, budget)) {
    }
    ASSERT_TRUE(registry_->exclude("lab", 0, SeqRange{3, 9}));
    stream("a", 3);
    ASSERT_TRUE(job.resume(log().size(), budget));
    while (job.run(log_, budget)) {
    }
    auto expected = projection_of(log_without_excluded(log()), config_);
    EXPECT_EQ(testing_support::digests_of(*job.maps()), testing_support::digests_of(expected.snapshot()));

    ReplayJob earlier(session()->info(), {config_, {.revision = 8}}, 8);
    EXPECT_FALSE(job.base_for(earlier, 8)) << "the earlier maps contain the excluded scans";
}

TEST_F(ExclusionsTest, InvalidRequestsAreRefusedWithAMessage) {
    create();
    stream("a", 3);
    const auto refusal = [&](const auto& done) { return std::pair(done.error().code, done.error().message); };
    using testing::Pair;
    EXPECT_THAT(refusal(registry_->exclude("none", 0, SeqRange{1, 1})), Pair(Errc::kNotFound, HasSubstr("'none'")));
    EXPECT_THAT(refusal(registry_->lift_exclusion("lab", 1)), Pair(Errc::kNotFound, HasSubstr("no exclusion 1")));
    ASSERT_TRUE(registry_->exclude("lab", 0, SeqRange{1, 1}));
    ASSERT_TRUE(registry_->lift_exclusion("lab", 1));
    EXPECT_THAT(refusal(registry_->lift_exclusion("lab", 1)),
                Pair(Errc::kNotFound, HasSubstr("no exclusion 1 in effect")));
    registry_->drain();
    EXPECT_EQ(registry_->exclude("lab", 0, SeqRange{1, 1}).error().code, Errc::kShuttingDown);
}

TEST_F(ExclusionsTest, HaveNoEffectIfNotStored) {
    create();
    stream("a", 8);
    const auto before = testing_support::digests_of(*session()->snapshot());
    log_.refuse_appends(1);
    EXPECT_EQ(registry_->exclude("lab", 0, SeqRange{2, 4}).error().code, Errc::kOverloaded);
    EXPECT_EQ(testing_support::digests_of(*session()->snapshot()), before);
    stream("a", 2);
    expect_that_excluded_scans_leave_no_trace();
}

} // namespace
} // namespace scanloom::sessions
