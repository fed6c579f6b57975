#pragma once

#include "server/http/handlers/call.hpp"
#include "server/http/response.hpp"
#include "server/store/backups.hpp"

namespace scanloom::http {

/// GET /api/v1/backups: those there are, oldest first.
/// @param backups  null: the server keeps none.
/// Errors  kNotFound: it keeps none; those of Backups::list().
[[nodiscard]] Result<Response> list_backups(store::Backups* backups, const Call& call);

/// POST /api/v1/backups: makes one; it is there when this is answered, which takes as long as copying what is new.
/// Errors  as above; those of Backups::make().
[[nodiscard]] Result<Response> make_backup(store::Backups* backups, store::ScanLog& log, const Call& call);

} // namespace scanloom::http
