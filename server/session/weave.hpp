#pragma once

#include "common/error/error.hpp"
#include "server/mapping/projection.hpp"
#include "server/session/page_budget.hpp"
#include "server/session/session_info.hpp"
#include "server/session/weave_request.hpp"
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

/// The maps of a session made once more from its log: with other settings, or as they were at some time. They are
/// those that a session would have which was created with these settings and given this log.
///
/// A weave has a target, an entry of the log. One that follows its session is given a later target whenever it is asked
/// for again, and goes on from where it is: no entry is folded twice. It works in rounds, each up to the target as it
/// was when the round began, and shows the maps of its last round meanwhile. So whoever asks is served when his entry
/// is in, however many ask after him.
///
/// One that has not begun may begin where another of the same session and settings stands, and then is on its own:
/// whatever becomes of the other, nothing is missing. The maps are the same as from nothing, bit for bit.
/// Memory  a round takes its chunks from the budget, also those of earlier maps that it has copied, to change them;
///         where they do not fit, it shows the earlier maps no longer. What it shares with the one that it began from
///         counts for either, as either may outlive the other.
/// Thread  any; run() and resume() as they say.
class Weave {
public:
    static constexpr double kTurnWork = 1e8; ///< as Reach::work: about a second, then others have theirs

    enum class State : std::uint8_t { kWaiting, kWeaving, kDone, kFailed, kCancelled };

    struct Progress {
        State state = State::kWaiting;
        Revision woven = 0;               ///< entries
        Revision target = 0;              ///< entries that are to be woven
        std::optional<Revision> revision; ///< of the maps, once there are any
        bool follows = false;             ///< the target can be raised
        std::optional<Error> error;       ///< why it failed or was cancelled
    };

    Weave(SessionInfo session, const WeaveRequest& request, Revision target)
        : id_(weave_id_of(session, request)), session_(std::move(session)), request_(request), target_(target) {}

    [[nodiscard]] const std::string& id() const noexcept { return id_; }
    [[nodiscard]] const SessionInfo& session() const noexcept { return session_; }
    [[nodiscard]] const WeaveRequest& request() const noexcept { return request_; }

    /// Clients see it among the weaves of the session. What GET asks for is not listed: GET changes nothing that
    /// others see. The number orders the list, the newest has the greatest; 0: not listed.
    void set_listed(std::uint64_t number) noexcept { listed_ = number; }
    [[nodiscard]] std::uint64_t listed() const noexcept { return listed_; }

    [[nodiscard]] Progress progress() const;

    /// The newest that are finished; null: none yet.
    [[nodiscard]] std::shared_ptr<const mapping::Snapshot> maps() const;

    /// Waits for maps with this entry, but no longer than `patience`.
    /// Pre  a target up to it has been asked for. @return null: they are not there; progress() tells why.
    [[nodiscard]] std::shared_ptr<const mapping::Snapshot> wait(Revision revision,
                                                                std::chrono::milliseconds patience) const;

    /// Asks for maps up to `target`. @return whether nothing more is to be done for that: they are there, or whoever
    /// weaves them goes on until they are.
    [[nodiscard]] bool join(Revision target);

    /// The same when it is done: gets ready for another run().
    /// Pre  join() said no, the state is kDone, and nobody else does this. @return false: the budget has no room now.
    [[nodiscard]] bool resume(Revision target, PageBudget& budget);

    /// Where another weave may begin that wants these maps up to `target`: nothing when their settings or sessions are
    /// not the same, or this one is beyond what the other wants, has given up or has not begun, or is being run.
    [[nodiscard]] std::optional<Revision> base_for(const Weave& other, Revision target) const;

    /// Whether it will stand, when it ends, where the other may begin; whether that is worth waiting for is told by
    /// progress(). No two wait for each other, as the end of the other is later.
    [[nodiscard]] bool leads_to(const Weave& other, Revision target) const;

    /// Begins where the other stands. Pre: it has not begun, and nobody runs it or asks for this at the same time.
    /// @return false: the other cannot be begun from, or no longer; see base_for().
    [[nodiscard]] bool begin_from(Weave& base);

    /// Ends soon for that reason, if it has not ended yet.
    void cancel(Error reason);

    /// One turn, with a priority below that of everything else: to the target as it was when the round began, or as far
    /// as a turn goes. Ends early when it is cancelled, when the budget is used up, or when what the log holds cannot
    /// be woven with these settings; what was woven is then given up.
    /// Pre  never at the same time as itself. @return whether there is more to weave: to be run again.
    [[nodiscard]] bool run(store::ScanLog& log, PageBudget& budget, double turn_work = kTurnWork);

    /// Told to whoever runs it.
    [[nodiscard]] bool has_begun() const noexcept { return projection_.has_value(); }

private:
    [[nodiscard]] bool is_same_map(const Weave& other) const noexcept;
    [[nodiscard]] std::optional<Revision> revision_before(const Weave& other, Revision target) const;
    [[nodiscard]] std::optional<Revision> begin();
    [[nodiscard]] Result<bool> weave_up_to(Revision target, store::ScanLog& log, PageBudget& budget);
    [[nodiscard]] bool is_beyond_end(Revision revision, const LogEntry& entry) const;
    [[nodiscard]] Result<> begin_again(Revision target, store::ScanLog& log, PageBudget& budget);
    [[nodiscard]] bool wait_for_another_turn(Revision target);
    [[nodiscard]] Result<> fold(const LogEntry& entry, PageBudget& budget);
    [[nodiscard]] Result<> claim(PageBudget& budget);
    [[nodiscard]] bool claim(std::size_t chunks, PageBudget& budget);
    void forget_maps();
    [[nodiscard]] bool publish(Revision target, bool is_complete, PageBudget& budget);
    void give_up(const Error& error, PageBudget& budget);
    void end(State state, PageBudget& budget);

    const std::string id_;
    const SessionInfo session_;
    const WeaveRequest request_;

    std::atomic<Revision> woven_ = 0;
    std::atomic<bool> cancelled_ = false;
    std::atomic<std::uint64_t> listed_ = 0;

    // Whoever runs it, or resumes it, alone; while nobody does, whoever has the mutex.
    std::optional<mapping::Projection> projection_; // kept, so that it can go on, and others from it
    std::optional<double> newest_stamp_;            // seconds, of the scans in it
    std::int64_t claimed_ = 0;                      // chunks, of the budget; none when it has ended
    double turn_left_ = 0.0;                        // work, as Reach::work

    mutable std::mutex mutex_; // guards what follows
    mutable std::condition_variable changed_;
    State state_ = State::kWaiting;
    Revision target_;
    std::optional<Revision> round_; // the target of a round that is not over yet
    bool is_complete_ = false;      // nothing more can follow
    std::shared_ptr<const mapping::Snapshot> maps_;
    std::optional<Error> error_;
};

/// Nothing more will happen to it unless it is asked for again.
[[nodiscard]] constexpr bool has_ended(Weave::State state) noexcept {
    return state != Weave::State::kWaiting && state != Weave::State::kWeaving;
}

/// What whoever waits for a weave of a session that is deleted is told.
[[nodiscard]] Error session_was_deleted(const SessionInfo& session);

} // namespace scanloom::session
