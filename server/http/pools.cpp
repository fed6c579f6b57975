#include "server/http/pools.hpp"

#include <string>
#include <string_view>
#include <utility>

namespace scanloom::http {
namespace {

Result<Pools::Permit> take(const limits::Semaphore& semaphore, std::string_view refusal) {
    if (auto permit = semaphore.try_acquire()) return permit;
    return Error{Errc::kOverloaded, std::string(refusal)};
}

} // namespace

Pools::Pools(Executors executors, const ServerConfig& config)
    : executors_(std::move(executors)), store_(config.changes_max), imports_(config.imports_max),
      log_readings_(config.paths_max), plans_(config.plans_max), replays_(config.weaves_max) {}

const boost::asio::any_io_executor& Pools::executor_of(Pool pool) const noexcept {
    switch (pool) {
    case Pool::kMetrics: return executors_.metrics;
    case Pool::kWholeMaps: return executors_.whole_maps;
    case Pool::kLogReading: return executors_.log_reading;
    case Pool::kLogExport: return executors_.log_export;
    case Pool::kPlanning: return executors_.planning;
    case Pool::kStore:
    case Pool::kImport: return executors_.store;
    case Pool::kIo:
    case Pool::kQueries: break;
    }
    return executors_.queries;
}

Result<Pools::Permit> Pools::enter(Pool pool) const {
    switch (pool) {
    case Pool::kLogReading:
        return take(log_readings_, "too many trajectories, landmarks or clouds of points are being read at this "
                                   "moment; try again soon");
    case Pool::kPlanning: return take(plans_, "too many paths are being planned at this moment; try again soon");
    case Pool::kStore:
        return take(store_, "too many sessions are being created or deleted at this moment; try again soon");
    case Pool::kImport: return take(imports_, "other maps are being imported at this moment; try again soon");
    case Pool::kIo:
    case Pool::kMetrics:
    case Pool::kQueries:
    case Pool::kWholeMaps:
    case Pool::kLogExport: break;
    }
    return Permit();
}

Result<Pools::Permit> Pools::wait_for_replay() const {
    return take(replays_, "too many requests are waiting for maps at this moment; try again soon");
}

} // namespace scanloom::http
