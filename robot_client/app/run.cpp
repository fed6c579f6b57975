#include "robot_client/app/run.hpp"

#include "common/app/settings.hpp"
#include "common/net/await_tuple.hpp"
#include "robot_client/app/info.hpp"
#include "robot_client/app/lidars.hpp"
#include "robot_client/app/localization_notes.hpp"
#include "robot_client/app/make_foxglove.hpp"
#include "robot_client/app/make_source.hpp"
#include "robot_client/app/options.hpp"
#include "robot_client/app/progress.hpp"
#include "robot_client/app/truth.hpp"
#include "robot_client/uplink/live_feed.hpp"
#include "robot_client/uplink/recording_feed.hpp"
#include "robot_client/uplink/server_requests.hpp"
#include "robot_client/uplink/uplink.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/signal_set.hpp>
#include <fmt/format.h>

#include <csignal>
#include <random>
#include <variant>

namespace scanloom::robot {

namespace asio = boost::asio;

namespace {

/// Returns a message about the scans that the server has from earlier runs.
std::string resume_text(std::uint64_t stored, std::optional<std::uint64_t> scan_count) {
    if (scan_count == stored) return fmt::format("all {} scans are stored from an earlier run", stored);
    return fmt::format("continuing after scan {}: earlier scans are stored from an earlier run", stored);
}

UplinkOptions uplink_options(const RobotOptions& options, std::string token, const PreparedSource& prepared,
                             Console& console) {
    UplinkOptions uplink;
    uplink.servers = options.servers;
    const auto default_timeout = prepared.live ? std::chrono::milliseconds(0) : uplink.give_up_after;
    uplink.give_up_after = options.give_up_after.value_or(default_timeout);
    uplink.give_up_after_end = options.give_up_after.value_or(uplink.give_up_after_end);
    uplink.backoff_seed = std::random_device{}();
    uplink.on_trouble = report_once([&console](const std::string& text) { console.note(text); });
    uplink.protocol.batch_delay = options.batch_delay;
    uplink.protocol.batch_bytes_max = options.batch_bytes_max;
    uplink.protocol.compress = options.compress;
    uplink.buffer_bytes_max = options.memory_bytes_max;
    wire::Hello& hello = uplink.protocol.hello;
    hello.robot = options.robot;
    hello.session = options.session;
    hello.token = std::move(token);
    hello.create = SessionOptions{};
    hello.create->cell_size = options.cell_size;
    hello.client = fmt::format("scanloom-robot {}", kVersion);
    hello.source = prepared.fingerprint;
    hello.body_radius = options.body_radius ? options.body_radius : prepared.body_radius;
    hello.poses = prepared.poses;
    return uplink;
}

RecordingFeedOptions recording_options(const PreparedSource& prepared, Console& console) {
    RecordingFeedOptions feed;
    feed.speed = prepared.speed;
    feed.on_resume = [&console, scan_count = prepared.source->scan_count()](std::uint64_t stored) {
        console.note(resume_text(stored, scan_count));
    };
    feed.on_long_pause = [&console](std::chrono::duration<double> pause) { console.note(pause_text(pause)); };
    return feed;
}

/// Opens the spool of a live source. Returns null if there is none.
/// Errors: those of Spool::open().
Result<std::unique_ptr<Spool>> open_spool(const RobotOptions& options, const PreparedSource& prepared,
                                          Console& console) {
    if (!prepared.live) return std::unique_ptr<Spool>{};
    const bool has_survey = prepared.foxglove != nullptr;
    auto spool = open_spool_of(options.session, options.robot,
                               {.directory = options.spool,
                                .bytes_max = options.spool_bytes_max,
                                .when_full = options.when_full,
                                .poses_from_server = prepared.locating != nullptr,
                                .poses = has_survey ? options.poses : prepared.poses},
                               [&console](const std::string& text) { console.note(text); });
    if (spool && *spool && (*spool)->waiting() > 0)
        console.note(fmt::format("{} scans wait in {}", (*spool)->waiting(), (*spool)->directory().string()));
    return spool;
}

/// Returns what the poses of a robot with foxglove_bridge are. While scans of an earlier run wait in the spool, they
/// are sent first, and those to come must have the same poses; otherwise the robot is surveyed.
/// Errors: those of survey_robot() and Spool::state_poses().
Result<Poses> poses_of(FoxgloveSource& robot, Spool* spool, asio::io_context& io) {
    if (spool != nullptr && spool->poses()) robot.expect_poses(*spool->poses());
    if (spool != nullptr && spool->poses() && spool->waiting() > 0) return *spool->poses();
    auto poses = survey_robot(io, robot);
    if (!poses || spool == nullptr) return poses;
    if (auto stated = spool->state_poses(*poses); !stated) return stated.error();
    return poses;
}

std::unique_ptr<Feed> make_feed(const RobotOptions& options, const PreparedSource& prepared,
                                std::unique_ptr<Spool> spool, Console& console) {
    if (prepared.source) return std::make_unique<RecordingFeed>(*prepared.source, recording_options(prepared, console));
    const auto report = [&console](const std::string& text) { console.note(text); };
    const auto on_resume = [&console](std::uint64_t stored) { console.note(resume_text(stored, std::nullopt)); };
    return std::make_unique<LiveFeed>(*prepared.live, std::move(spool),
                                      LiveFeedOptions{options.when_full, on_resume, report});
}

/// The first signal stops the source, the second one stops everything.
asio::awaitable<void> obey_signals(asio::io_context& io, Uplink& uplink, Console& console) {
    asio::signal_set signals(io, SIGINT, SIGTERM);
    if (std::get<0>(co_await signals.async_wait(kAwaitTuple))) co_return;
    console.note("interrupted: waiting until sent scans are stored; interrupt again to end immediately");
    uplink.stop();
    if (std::get<0>(co_await signals.async_wait(kAwaitTuple))) co_return;
    io.stop();
}

asio::awaitable<void> show_progress(asio::io_context& io, const Uplink& uplink, const Feed& feed,
                                    const PreparedSource& prepared, Console& console) {
    const auto begun = std::chrono::steady_clock::now();
    asio::steady_timer timer(io);
    RecentRate rate;
    static_cast<void>(rate.update({}, 0));
    for (;;) {
        timer.expires_after(console.progress_period());
        if (std::get<0>(co_await timer.async_wait(kAwaitTuple))) co_return;
        const UplinkStatus status = uplink.status();
        const std::uint64_t stored_now = status.acknowledged - status.resumed_after;
        console.progress(progress_text(status, feed.scan_count(),
                                       rate.update(std::chrono::steady_clock::now() - begun, stored_now),
                                       prepared.live ? prepared.live->remarks() : std::string()));
    }
}

} // namespace

ExitCode run(const RobotOptions& options) {
    Console console(standard_error());
    const auto fail = [&](const Error& error) {
        console.note("scanloom-robot: " + error.message);
        return kExitFailed;
    };
    auto token = read_token(options.token_file);
    if (!token) return fail(token.error());
    auto prepared = make_source(options, console);
    if (!prepared) return fail(prepared.error());

    auto spool = open_spool(options, *prepared, console);
    if (!spool) return fail(spool.error());

    asio::io_context io(1);
    if (prepared->foxglove != nullptr) {
        const auto poses = poses_of(*prepared->foxglove, spool->get(), io);
        if (!poses && poses.error().code == Errc::kShuttingDown) {
            console.note("interrupted before the robot was surveyed: nothing was sent");
            fmt::print("{}\n", summary_json({.session = options.session,
                                             .robot = options.robot,
                                             .source = prepared->fingerprint,
                                             .left_out = prepared->left_out_now(),
                                             .remarks = prepared->remarks()}));
            return kExitDone;
        }
        if (!poses) return fail(poses.error());
        prepared->poses = *poses;
    }
    const auto feed = make_feed(options, *prepared, std::move(*spool), console);

    UplinkOptions sent_options = uplink_options(options, *token, *prepared, console);
    auto tls = tls_of(options, options.tls);
    if (!tls) return fail(tls.error());
    sent_options.tls = std::move(*tls);

    auto* const steered = prepared->poses == Poses::kOdometry ? prepared->exploring : nullptr;
    LocalizationNotes notes;
    sent_options.protocol.on_correction = [&console, &notes, steered,
                                           robot = prepared->foxglove](const wire::Correction& correction) {
        if (steered != nullptr) steered->correct(correction.T_map_odom, correction.state);
        const bool is_located = correction.state != LocalizationState::kUnlocated;
        if (robot != nullptr) robot->correct(is_located ? std::optional(correction.T_map_odom) : std::nullopt);
        for (const auto& note : notes.add(correction)) console.note(note);
    };

    Uplink uplink(io, std::move(sent_options), *feed);
    if (prepared->exploring != nullptr) prepared->exploring->ask_with(guided_by(uplink, sim::Explore::kPathClearance));
    if (prepared->locating != nullptr)
        prepared->locating->ask_with(located_by(uplink, prepared->near, prepared->first_place));
    std::optional<Result<>> outcome; // none if a second signal ended the run
    const auto begun = std::chrono::steady_clock::now();
    asio::co_spawn(io, obey_signals(io, uplink, console), asio::detached);
    asio::co_spawn(io, show_progress(io, uplink, *feed, *prepared, console), asio::detached);
    asio::co_spawn(io, uplink.run(), [&](const std::exception_ptr& failed, Result<> result) {
        if (failed) std::rethrow_exception(failed);
        outcome = std::move(result);
        io.stop();
    });
    io.run();

    if (!outcome) outcome = uplink.outcome_when_interrupted();
    console.finish();
    if (const auto remarks = prepared->remarks(); !remarks.empty()) console.note(remarks);
    fmt::print("{}\n", summary_json({options.session, options.robot, prepared->fingerprint, prepared->order,
                                     uplink.status(), prepared->skipped_lines, prepared->left_out_now(),
                                     std::chrono::steady_clock::now() - begun, feed->scan_count(),
                                     notes.state() ? name_of(*notes.state()) : std::string_view(), prepared->remarks(),
                                     *outcome ? "" : outcome->error().message}));
    if (*outcome) return kExitDone;
    const bool is_refused = outcome->error().code == Errc::kConflict;
    if (is_refused && prepared->locating != nullptr && !options.spool.empty()) {
        console.note(fmt::format("to localize the lidar again, move {0}/{1}.{2} away; or rename it to OTHER.{2} to "
                                 "send its scans to --session OTHER",
                                 options.spool.string(), options.session, options.robot));
    }
    return fail(outcome->error());
}

ExitCode run(int argc, const char* const* argv) {
    const auto options = parse_options(argc, argv);
    if (const auto* leave = std::get_if<Leave>(&options)) {
        fmt::print(leave->code == kExitDone ? stdout : stderr, "{}", leave->text);
        return leave->code;
    }
    if (const auto* truth = std::get_if<GroundTruthOptions>(&options)) return run(*truth);
    if (const auto* info = std::get_if<InfoOptions>(&options)) return run(*info);
    if (const auto* lidars = std::get_if<LidarsOptions>(&options)) return run(*lidars);
    return run(std::get<RobotOptions>(options));
}

} // namespace scanloom::robot
