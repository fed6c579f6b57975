#pragma once

#include "server/http/handlers/call.hpp"
#include "server/http/response.hpp"
#include "server/store/backups.hpp"

namespace scanloom::http {

/// GET /api/v1/backups: lists the backups, oldest first.
/// @param backups  null if the server keeps none
/// Errors: kNotFound if the server keeps none; those of Backups::list().
[[nodiscard]] Result<Response> list_backups(store::Backups* backups, const Call& call);

/// POST /api/v1/backups: makes a backup. The response follows when it is complete, after the new data has been copied.
/// Errors: those of list_backups() and Backups::make().
[[nodiscard]] Result<Response> make_backup(store::Backups* backups, store::ScanLog& log, const Call& call);

} // namespace scanloom::http
