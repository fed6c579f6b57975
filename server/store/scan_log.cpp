#include "server/store/scan_log.hpp"

#include <future>
#include <memory>
#include <utility>

namespace scanloom::store {

Result<std::string> ScanLog::identity() {
    return Error{Errc::kInvalidField, "this log is not kept on a disk: there is nothing to copy"};
}

Result<> ScanLog::backup_to(const std::filesystem::path&, const std::stop_token&) {
    return Error{Errc::kInvalidField, "this log is not kept on a disk: there is nothing to copy"};
}

Result<> append_and_wait(ScanLog& log, SessionId session, Revision first, std::vector<std::string> entries) {
    const auto outcome = std::make_shared<std::promise<Result<>>>();
    auto appended = outcome->get_future();
    log.append(session, first, std::move(entries), [outcome](Result<> done) { outcome->set_value(std::move(done)); });
    return appended.get();
}

} // namespace scanloom::store
