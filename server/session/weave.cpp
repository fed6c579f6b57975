#include "server/session/weave.hpp"

#include "common/hash/sha256.hpp"
#include "common/wire/log_codec.hpp"
#include "server/mapping/map_config.hpp"
#include "server/mapping/reach.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <map>
#include <span>
#include <utility>

namespace scanloom::session {
namespace {

constexpr double kSliceWork = 5e6; // until it is looked whether to go on
constexpr int kNiceness = 10;      // weaving again is never more urgent than what robots and viewers wait for

/// Not failures, but reasons to read no further.
const Error kEnd{Errc::kShuttingDown, "the end of what is to be woven"};
const Error kCancelled{Errc::kShuttingDown, "cancelled"};

Error no_room() {
    return {Errc::kFull,
            "this map and others that are woven at the moment need more memory than there is for them; use "
            "larger cells, or try again when the others are done"};
}

/// Linux: of this thread alone.
void step_back() { static_cast<void>(setpriority(PRIO_PROCESS, 0, kNiceness)); }

/// What no robot is told any more, since its log is what it is.
Result<> check_entry(const mapping::MapConfig& config, const LogEntry& entry) {
    if (const auto* described = std::get_if<SensorDescribed>(&entry)) {
        return mapping::check_reach(config, described->sensor);
    }
    const auto* patch = std::get_if<MapPatch>(&entry);
    return patch == nullptr ? Result<>{} : mapping::check_work(mapping::reach_of(config, *patch));
}

/// The sensors that a log has described so far.
class Sensors {
public:
    /// Errors  kInvalidField: a scan that no session with these settings would have taken.
    [[nodiscard]] Result<> check(const mapping::MapConfig& config, const LogEntry& entry) {
        if (const auto* described = std::get_if<SensorDescribed>(&entry)) {
            known_[{described->robot, described->sensor.id}] = described->sensor;
        }
        const auto* taken = std::get_if<ScanTaken>(&entry);
        if (taken == nullptr) return {};
        const auto sensor = known_.find({taken->robot, taken->scan.sensor});
        if (sensor == known_.end()) return {}; // which folding will tell
        return mapping::check_work(mapping::reach_of(config, sensor->second, taken->scan));
    }

private:
    std::map<std::pair<RobotIndex, std::uint32_t>, Sensor> known_;
};

} // namespace

std::string weave_id_of(const SessionInfo& session, const WeaveRequest& request) {
    std::string text = fmt::format("{} until {}", tag_of(session), request.end.revision);
    if (request.end.stamp) text += fmt::format(" or {}", *request.end.stamp);
    for (const auto& field : mapping::config_fields()) {
        std::visit([&](const auto& value) { text += fmt::format("\n{} {}", field.name, value); },
                   mapping::value_of(field, request.config));
    }
    Sha256 hash;
    hash.update(std::as_bytes(std::span(text)));
    return hash.hex().substr(0, 16);
}

Weave::Progress Weave::progress() const {
    const std::lock_guard lock(mutex_);
    return {state_, woven_, error_};
}

std::shared_ptr<const mapping::Snapshot> Weave::maps() const {
    const std::lock_guard lock(mutex_);
    return maps_;
}

bool Weave::wait(std::chrono::milliseconds patience) const {
    std::unique_lock lock(mutex_);
    return ended_.wait_for(lock, patience, [&] { return state_ != State::kWaiting && state_ != State::kWeaving; });
}

void Weave::cancel() {
    cancelled_ = true;
    const std::lock_guard lock(mutex_);
    if (state_ != State::kWaiting) return; // whoever weaves will see it
    state_ = State::kCancelled;
    ended_.notify_all();
}

void Weave::run(store::ScanLog& log, ChunkBudget& budget) {
    {
        const std::lock_guard lock(mutex_);
        if (state_ != State::kWaiting) return; // cancelled
        state_ = State::kWeaving;
    }
    step_back();
    std::int64_t chunks = 0;
    try {
        mapping::Projection projection(request_.config);
        const auto woven = weave(log, budget, projection, chunks);
        if (woven || woven.error() == kEnd) {
            end(State::kDone, std::make_shared<const mapping::Snapshot>(projection.snapshot()), std::nullopt);
        } else if (woven.error() == kCancelled) {
            end(State::kCancelled, nullptr, std::nullopt);
        } else {
            end(State::kFailed, nullptr, woven.error());
        }
    } catch (const std::bad_alloc&) {
        end(State::kFailed, nullptr, no_room());
    }
    budget.give_back(chunks);
}

Result<> Weave::weave(store::ScanLog& log, ChunkBudget& budget, mapping::Projection& projection, std::int64_t& chunks) {
    Sensors sensors;
    return log.read(session_, 0, [&](Revision revision, std::string_view bytes) -> Result<> {
        if (revision > request_.end.revision) return kEnd;
        const auto entry = wire::decode_entry(bytes);
        if (!entry) return prefixed(fmt::format("log entry {}: ", revision), entry.error());
        const auto* taken = std::get_if<ScanTaken>(&*entry);
        if (taken != nullptr && request_.end.stamp && taken->scan.stamp > *request_.end.stamp) return kEnd;
        if (auto ok = sensors.check(request_.config, *entry); !ok) return ok;
        return fold(*entry, budget, projection, chunks);
    });
}

Result<> Weave::fold(const LogEntry& entry, ChunkBudget& budget, mapping::Projection& projection,
                     std::int64_t& chunks) {
    if (auto ok = check_entry(request_.config, entry); !ok) return ok;
    for (bool in = false; !in;) {
        if (cancelled_) return kCancelled;
        double work = kSliceWork;
        const auto folded = projection.fold(entry, work);
        if (!folded) return folded.error();
        in = *folded;
        const std::int64_t more = static_cast<std::int64_t>(projection.chunk_count()) - chunks;
        chunks += more;
        if (!budget.take(more)) return no_room();
    }
    woven_ = projection.revision();
    return {};
}

void Weave::end(State state, std::shared_ptr<const mapping::Snapshot> maps, std::optional<Error> error) {
    const std::lock_guard lock(mutex_);
    state_ = state;
    maps_ = std::move(maps);
    error_ = std::move(error);
    ended_.notify_all();
}

} // namespace scanloom::session
