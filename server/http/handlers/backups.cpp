#include "server/http/handlers/backups.hpp"

#include <boost/json/array.hpp>
#include <boost/json/object.hpp>

namespace scanloom::http {
namespace {

Error none_kept() {
    return {Errc::kNotFound, "this server keeps no backups; start it with --backups DIR, a directory on another disk"};
}

boost::json::object backup_json(const store::Backup& backup) {
    return {{"id", backup.id}, {"time", backup.time}, {"bytes", backup.bytes}, {"sessions", backup.sessions}};
}

} // namespace

Result<Response> list_backups(store::Backups* backups, const Call& call) {
    if (auto known = call.query.check_only({}); !known) return known.error();
    if (backups == nullptr) return none_kept();
    const auto there = backups->list();
    if (!there) return there.error();
    boost::json::array listed;
    for (const auto& backup : *there) listed.push_back(backup_json(backup));
    return ok(boost::json::object{{"backups", std::move(listed)}, {"kept", backups->kept()}});
}

Result<Response> make_backup(store::Backups* backups, store::ScanLog& log, const Call& call) {
    if (auto known = call.query.check_only({}); !known) return known.error();
    if (backups == nullptr) return none_kept();
    const auto made = backups->make(log);
    if (!made) return made.error();
    auto response = ok(backup_json(*made));
    response.status = Status::created;
    return response;
}

} // namespace scanloom::http
