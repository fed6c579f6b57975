#pragma once

#include "common/error/error.hpp"
#include "server/mapping/projection.hpp"
#include "server/session/session_info.hpp"
#include "server/store/scan_log.hpp"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

namespace scanloom::session {

/// Where a weave ends. Both given: at what comes first.
struct WeaveEnd {
    Revision revision = 0;       ///< with this entry of the log
    std::optional<double> stamp; ///< seconds: before the first scan that was taken later

    friend bool operator==(const WeaveEnd&, const WeaveEnd&) = default;
};

/// What is to be woven of a session's log.
struct WeaveRequest {
    mapping::MapConfig config;
    WeaveEnd end;

    friend bool operator==(const WeaveRequest&, const WeaveRequest&) = default;
};

/// Tells a request from all others of all sessions: 16 hexadecimal digits.
[[nodiscard]] std::string weave_id_of(const SessionInfo& session, const WeaveRequest& request);

/// The chunks that all weaves under way may have together.
class ChunkBudget {
public:
    explicit ChunkBudget(std::size_t chunks_max) : free_(static_cast<std::int64_t>(chunks_max)) {}

    [[nodiscard]] bool take(std::int64_t chunks) noexcept { return free_.fetch_sub(chunks) >= chunks; }
    void give_back(std::int64_t chunks) noexcept { free_ += chunks; }

private:
    std::atomic<std::int64_t> free_;
};

/// The maps of a session made once more from its log: with other settings, or as they were at some time. They are
/// those that a session would have which was created with these settings and given this log.
/// Thread  any; run() on one.
class Weave {
public:
    enum class State : std::uint8_t { kWaiting, kWeaving, kDone, kFailed, kCancelled };

    struct Progress {
        State state = State::kWaiting;
        Revision woven = 0;         ///< entries
        std::optional<Error> error; ///< why it failed
    };

    Weave(const SessionInfo& session, const WeaveRequest& request)
        : id_(weave_id_of(session, request)), session_(session.id), request_(request) {}

    [[nodiscard]] const std::string& id() const noexcept { return id_; }
    [[nodiscard]] store::SessionId session() const noexcept { return session_; }
    [[nodiscard]] const WeaveRequest& request() const noexcept { return request_; }

    [[nodiscard]] Progress progress() const;

    /// The maps, once they are done.
    [[nodiscard]] std::shared_ptr<const mapping::Snapshot> maps() const;

    /// Until it is done, failed or cancelled, but no longer than `patience`. @return whether it is.
    bool wait(std::chrono::milliseconds patience) const;

    /// Ends soon, if it has not ended yet.
    void cancel();

    /// Weaves to the end, with a priority below that of everything else. Ends early when it is cancelled, when the
    /// budget is used up, or when what the log holds cannot be woven with these settings.
    void run(store::ScanLog& log, ChunkBudget& budget);

private:
    [[nodiscard]] Result<> weave(store::ScanLog& log, ChunkBudget& budget, mapping::Projection& projection,
                                 std::int64_t& chunks);
    [[nodiscard]] Result<> fold(const LogEntry& entry, ChunkBudget& budget, mapping::Projection& projection,
                                std::int64_t& chunks);
    void end(State state, std::shared_ptr<const mapping::Snapshot> maps, std::optional<Error> error);

    const std::string id_;
    const store::SessionId session_;
    const WeaveRequest request_;

    std::atomic<Revision> woven_ = 0;
    std::atomic<bool> cancelled_ = false;

    mutable std::mutex mutex_; // guards what follows
    mutable std::condition_variable ended_;
    State state_ = State::kWaiting;
    std::shared_ptr<const mapping::Snapshot> maps_;
    std::optional<Error> error_;
};

} // namespace scanloom::session
