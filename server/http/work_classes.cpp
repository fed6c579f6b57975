#include "server/http/work_classes.hpp"

#include <string>
#include <string_view>
#include <utility>

namespace scanloom::http {
namespace {

Result<WorkClasses::Permit> take(const limits::Semaphore& semaphore, std::string_view refusal) {
    if (auto permit = semaphore.try_acquire()) return permit;
    return Error{Errc::kOverloaded, std::string(refusal)};
}

} // namespace

WorkClasses::WorkClasses(Executors executors, const ServerConfig& config)
    : executors_(std::move(executors)), store_(config.changes_max), imports_(config.imports_max),
      log_readings_(config.paths_max), plans_(config.plans_max), replays_(config.weaves_max) {}

const boost::asio::any_io_executor& WorkClasses::executor_of(WorkClass work) const noexcept {
    switch (work) {
    case WorkClass::kMetrics: return executors_.metrics;
    case WorkClass::kWholeMaps: return executors_.whole_maps;
    case WorkClass::kLogReading: return executors_.log_reading;
    case WorkClass::kLogExport: return executors_.log_export;
    case WorkClass::kPlanning: return executors_.planning;
    case WorkClass::kStore:
    case WorkClass::kImport: return executors_.store;
    case WorkClass::kIo:
    case WorkClass::kQueries: break;
    }
    return executors_.queries;
}

Result<WorkClasses::Permit> WorkClasses::enter(WorkClass work) const {
    switch (work) {
    case WorkClass::kLogReading:
        return take(log_readings_, "too many trajectories, landmarks or clouds of points are being read at this "
                                   "moment; try again soon");
    case WorkClass::kPlanning: return take(plans_, "too many paths are being planned at this moment; try again soon");
    case WorkClass::kStore:
        return take(store_, "too many sessions are being created or deleted at this moment; try again soon");
    case WorkClass::kImport: return take(imports_, "other maps are being imported at this moment; try again soon");
    case WorkClass::kIo:
    case WorkClass::kMetrics:
    case WorkClass::kQueries:
    case WorkClass::kWholeMaps:
    case WorkClass::kLogExport: break;
    }
    return Permit();
}

Result<WorkClasses::Permit> WorkClasses::wait_for_replay() const {
    return take(replays_, "too many requests are waiting for maps at this moment; try again soon");
}

} // namespace scanloom::http
