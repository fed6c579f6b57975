#include "common/scan/mount_message.hpp"
#include "server/log/context.hpp"
#include "server/sessions/session.hpp"

#include <boost/asio/post.hpp>

#include <algorithm>
#include <set>
#include <utility>

/// Reports estimated poses to robots, and lets the maps of a session follow them.
namespace scanloom::sessions {
namespace {

constexpr double kCorrectionWork = 2e7; // of a turn that corrects the maps, in the unit of Reach::work: some 20 ms
constexpr Revision kEntriesLeft = 256;  // that corrected maps may lack when they are announced

} // namespace

void Session::correct_maps() {
    on_strand([](Session& self) { self.begin_correction(); });
}

void Session::read_poses(std::function<void(const localization::SessionPoses&)> read) {
    on_strand([read = std::move(read)](Session& self) { read(self.maps_.localized().poses()); });
}

void Session::relocalize(const RobotRelocalized& relocalized, std::function<void(Result<>)> done) {
    on_strand([relocalized, done = std::move(done)](Session& self) {
        if (self.refusing_) return done(*self.refusing_);
        auto entry = self.sequencer_.relocalize(relocalized);
        if (!entry) return done(entry.error());
        std::vector<PendingEntry> entries;
        entries.push_back(std::move(*entry));
        self.enqueue(std::move(entries));
        done({});
    });
}

void Session::change_mode(const ModeChanged& changed, std::function<void(Result<>)> done) {
    on_strand([changed, done = std::move(done)](Session& self) {
        if (self.refusing_) return done(*self.refusing_);
        auto entry = self.sequencer_.change_mode(changed);
        if (!entry) return done(entry.error());
        std::vector<PendingEntry> entries;
        if (*entry) entries.push_back(std::move(**entry));
        if (!entries.empty()) self.enqueue(std::move(entries));
        done({});
    });
}

/// Begins to make the maps at the corrected poses, beside those that are shown.
void Session::begin_correction() {
    if (correction_ || refusing_ || !maps_.localized().is_outdated()) return;
    const auto& poses = maps_.localized().poses();
    correction_ =
        std::make_shared<MapCorrection>(log_, info_.id, maps_.projection(), poses.in_maps(), poses.corrected());
    continue_correction();
}

void Session::continue_correction() {
    correction_->set_poses(maps_.localized().poses().in_maps());
    auto apply = [self = shared_from_this(), correction = correction_, target = maps_.projection().revision()] {
        double work = kCorrectionWork;
        const auto applied = correction->apply_up_to(target, work, self->finish_early_);
        self->on_strand([applied](Session& session) { session.on_corrected(applied); });
    };
    boost::asio::post(strand_.get_inner_executor(), std::move(apply)); // the strand continues to apply entries
}

/// Announces the corrected maps when they contain almost all entries. They are shown when the log contains this entry.
void Session::on_corrected(const Result<>& applied) {
    if (!correction_) return;
    if (!applied && !refusing_) {
        log::warn({.session = info_.name}, "session '{}': its maps show poses that have been corrected: {}", info_.name,
                  applied.error().message);
    }
    if (!applied || refusing_) return drop_correction(); // the next group begins another one
    const auto pages = correction_->page_count();
    share_.take_anyway(static_cast<std::int64_t>(pages - std::exchange(correction_pages_, pages)));
    if (maps_.projection().revision() - correction_->revision() > kEntriesLeft) return continue_correction();
    maps_.set_correction(correction_);
    std::vector<PendingEntry> entries;
    entries.push_back(sequencer_.announce({correction_->as_of()}));
    enqueue(std::move(entries));
}

void Session::drop_correction() {
    correction_.reset();
    maps_.set_correction(nullptr);
    share_.give_back(static_cast<std::int64_t>(std::exchange(correction_pages_, 0)));
}

/// Counts what was done about loops since the last call.
void Session::count_loops() {
    if (!maps_.projection().has_estimated_poses()) return;
    std::size_t loops = 0;
    for (const auto& robot : snapshot()->robots) loops += robot.localization.loops;
    const std::size_t before = std::exchange(loops_, loops);
    counters_->loops_accepted += loops - std::min(loops, before);
    const auto& figures = maps_.localized().poses().map().loop_figures();
    counters_->loop_search.add(std::exchange(loop_figures_, figures), figures);
}

/// Logs which robots were lost or found again, and once of each laser that its mount seems to be wrong.
void Session::log_localization() {
    if (!maps_.projection().has_estimated_poses()) return;
    for (const auto& robot : snapshot()->robots) {
        const bool is_lost = robot.localization.state == LocalizationState::kLost;
        if (is_lost && lost_.insert(robot.name).second) {
            log::warn({.session = info_.name},
                      "session '{}', robot '{}' is lost: its newest scans fit no place in the map and are not in it",
                      info_.name, robot.name);
        } else if (!is_lost && lost_.erase(robot.name) > 0) {
            log::info({.session = info_.name}, "session '{}', robot '{}' is found again", info_.name, robot.name);
        }
        const auto& error = robot.localization.mount_yaw_error;
        if (!error || !warned_of_.insert(robot.name).second) continue;
        log::warn({.session = info_.name}, "session '{}', robot '{}': {}", info_.name, robot.name,
                  mount_message(*error));
    }
}

/// Reports to each robot with estimated poses where it is by its newest scan, if that is in the group.
void Session::report_places(const Group& group) {
    std::set<RobotIndex> robots;
    for (const auto& applied : group.entries) {
        if (applied.entry && std::holds_alternative<ScanTaken>(*applied.entry)) robots.insert(applied.robot);
    }
    for (const RobotIndex robot : robots) {
        const auto* poses = maps_.localized().poses().find(robot);
        auto* listener = sequencer_.listener_of(robot);
        if (poses == nullptr || listener == nullptr) continue;
        const bool has_odometry = maps_.projection().robots()[robot].poses == Poses::kOdometry;
        const auto known = poses->localization();
        const auto& location = poses->location();
        Pose2 reported = has_odometry ? location.T_map_odom : location.T_map_robot;
        if (known.state == LocalizationState::kUnlocated) reported = {}; // its place is in a frame of its own
        listener->on_located({reported, maps_.projection().revision(), known.inlier_ratio, known.position_sigma,
                              known.yaw_sigma, known.state, known.mount_yaw_error});
    }
}

} // namespace scanloom::sessions
