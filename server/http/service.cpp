#include "server/http/service.hpp"

namespace scanloom::http {

Result<std::shared_ptr<const void>> take_slot(const Service& service, Lane lane) {
    std::shared_ptr<const void> slot;
    if (lane == Lane::kChanging) {
        slot = service.changes.try_take();
        if (!slot) {
            return Error{Errc::kOverloaded,
                         "too many sessions are being created or deleted at this moment; try again soon"};
        }
    }
    if (lane == Lane::kImporting) {
        slot = service.imports.try_take();
        if (!slot) return Error{Errc::kOverloaded, "other maps are being imported at this moment; try again soon"};
    }
    if (lane == Lane::kWeaving) {
        slot = service.weaves.try_take();
        if (!slot) return Error{Errc::kOverloaded, "too many maps are being waited for at this moment; try again soon"};
    }
    if (lane == Lane::kPaths) {
        slot = service.paths.try_take();
        if (!slot)
            return Error{Errc::kOverloaded,
                         "too many paths, landmarks or clouds of points are being read at this moment; try again soon"};
    }
    if (lane == Lane::kPlanning) {
        slot = service.plans.try_take();
        if (!slot) return Error{Errc::kOverloaded, "too many ways are being looked for at this moment; try again soon"};
    }
    return slot;
}

const boost::asio::any_io_executor& executor_of(const Executors& executors, Lane lane) {
    switch (lane) {
    case Lane::kTelling: return executors.telling;
    case Lane::kSurvey: return executors.survey;
    case Lane::kPaths: return executors.paths;
    case Lane::kLog: return executors.logs;
    case Lane::kWeaving: return executors.weaving;
    case Lane::kPlanning: return executors.planning;
    case Lane::kImporting:
    case Lane::kChanging: return executors.changing;
    default: return executors.serving;
    }
}

} // namespace scanloom::http
