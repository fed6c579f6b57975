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

/// From a request to its answer: target -> route -> handler. Here each handler is given what it uses.
/// Bounds  large answers, map images of up to 64 MB above all, have slots; tiles that are kept take tile_bytes_max.
/// Thread  answer() may be called from any number of threads; what it refers to must outlive it.
class Api {
public:
    Api(session::SessionRegistry& sessions, session::Weaves& weaves, guide::GoalBook& goals, store::ScanLog& log,
        const metrics::Metrics& metrics, const Doorman& doorman, WebFiles web,
        std::size_t tile_bytes_max = tiles::TileMaker::kBytesMax)
        : sessions_(sessions), weaves_(weaves), goals_(goals), maps_(sessions, weaves), tiles_(tile_bytes_max),
          log_(log), metrics_(metrics), doorman_(doorman), web_(std::move(web)) {}

    /// From now on the sessions are served; before, whoever asks for them is told to wait.
    void set_recovered() noexcept { recovered_ = true; }

    /// Pre  nobody asks yet.
    void set_robot_port(RobotPort robots) { robots_ = std::move(robots); }

    /// Where backups are made; without, there are none. Pre  nobody asks yet.
    void set_backups(store::Backups& backups) { backups_ = &backups; }

    /// It forgets sessions that are deleted. Pre  nobody asks yet.
    void set_locator(guide::Locator& locator) { locator_ = &locator; }

    /// What it finds is told, too. Pre  nobody asks yet.
    void set_background_check(const session::BackgroundCheck& check) { check_ = &check; }

    /// Every failure is an answer too: application/problem+json.
    [[nodiscard]] Response answer(const Request& request);

    /// For I/O threads, before answer(): the answer if it is there, else the lane on which to call answer().
    [[nodiscard]] Outlook look(const Request& request);

    /// Has the session read, where look() says so. `told` is called once, when it is there or cannot be had: look()
    /// again, and where it says the same, answer() knows why.
    void wake(const Asleep& asleep, std::function<void()> told);

    /// For I/O threads, before the request's body is read: the answer to a request whose header is enough to refuse it.
    [[nodiscard]] std::optional<Response> refuse(const Request& request) const;

private:
    /// A request whose header holds nothing that is refused.
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
