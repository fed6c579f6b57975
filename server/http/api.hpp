#pragma once

#include "server/guide/goal_book.hpp"
#include "server/guide/locator.hpp"
#include "server/http/answer_slots.hpp"
#include "server/http/doorman.hpp"
#include "server/http/handlers/health.hpp"
#include "server/http/handlers/maps_lookup.hpp"
#include "server/http/lane.hpp"
#include "server/http/request.hpp"
#include "server/http/response.hpp"
#include "server/http/router.hpp"
#include "server/http/target.hpp"
#include "server/http/web_files.hpp"
#include "server/live/landmark_hub.hpp"
#include "server/metrics/metrics.hpp"
#include "server/session/background_check.hpp"
#include "server/session/capture_folds.hpp"
#include "server/session/session_registry.hpp"
#include "server/session/weaves.hpp"
#include "server/store/backups.hpp"
#include "server/store/scan_log.hpp"
#include "server/tiles/tile_maker.hpp"

#include <atomic>
#include <cstddef>
#include <functional>
#include <optional>
#include <utility>
#include <variant>

namespace scanloom::http {

/// Answers requests: parses the target, finds the route, checks the permission and calls the handler with its
/// dependencies.
/// Bounds: large responses take a slot, such as map images of up to 64 MB; cached tiles take at most `tile_bytes_max`.
/// Threads: answer() may be called on any number of threads. All referenced objects must outlive this one.
class Api {
public:
    Api(session::SessionRegistry& sessions, session::Weaves& weaves, guide::GoalBook& goals, store::ScanLog& log,
        const metrics::Metrics& metrics, const Doorman& doorman, WebFiles web,
        std::size_t tile_bytes_max = tiles::TileMaker::kBytesMax)
        : sessions_(sessions), weaves_(weaves), goals_(goals), maps_(sessions, weaves), tiles_(tile_bytes_max),
          log_(log), metrics_(metrics), doorman_(doorman), web_(std::move(web)) {}

    /// Starts to serve sessions. Before this call, requests for sessions receive kOverloaded.
    void set_recovered() noexcept { recovered_ = true; }

    /// Sets where robots connect, for /readyz. Must be called before the first request.
    void set_robot_port(RobotPort robots) { robots_ = std::move(robots); }

    /// Enables backups. Without this call there are none. Must be called before the first request.
    void set_backups(store::Backups& backups) { backups_ = &backups; }

    /// Sets the locator that forgets deleted sessions. Must be called before the first request.
    void set_locator(guide::Locator& locator) { locator_ = &locator; }

    /// Adds the findings of `check` to the responses. Must be called before the first request.
    void set_background_check(const session::BackgroundCheck& check) { check_ = &check; }

    /// Computes the response. A failure becomes a response too, with application/problem+json.
    [[nodiscard]] Response answer(const Request& request);

    /// Returns the response if it is immediately available, else the lane on which to call answer(), or the session to
    /// load first.
    /// Threads: I/O threads, before answer().
    [[nodiscard]] Outlook look(const Request& request);

    /// Loads the session that look() returned. `on_loaded` is called once, when the session is in memory or failed to
    /// load. Then call look() again. If its result is the same, answer() returns the reason.
    void wake(const Asleep& asleep, std::function<void()> on_loaded);

    /// Returns the refusal of a request whose header is enough to refuse it, else nullopt.
    /// Threads: I/O threads, before the body is read.
    [[nodiscard]] std::optional<Response> refuse(const Request& request) const;

private:
    /// A request whose header passed all checks.
    struct Admitted {
        Match match;
        Query query;
        access::TokenRef who;
    };

    /// Checks everything but the body: path, method, permission, Content-Type.
    [[nodiscard]] std::variant<Admitted, Response> admit(const Request& request) const;
    [[nodiscard]] Response for_who_asked(Operation operation, Response response) const;
    [[nodiscard]] Result<Response> call(const Match& match, const Call& call);

    session::SessionRegistry& sessions_;
    session::Weaves& weaves_;
    guide::GoalBook& goals_;
    const MapsLookup maps_;
    tiles::TileMaker tiles_;
    store::ScanLog& log_;
    session::LandmarkFolds landmarks_{log_};
    live::LandmarkHub watched_landmarks_{landmarks_};
    const metrics::Metrics& metrics_;
    const Doorman doorman_;
    const WebFiles web_;
    const AnswerSlots slots_;
    RobotPort robots_;
    store::Backups* backups_ = nullptr;
    const session::BackgroundCheck* check_ = nullptr;
    guide::Locator* locator_ = nullptr;
    std::atomic<bool> recovered_ = false;
};

} // namespace scanloom::http
