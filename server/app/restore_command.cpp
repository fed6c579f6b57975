#include "server/app/restore_command.hpp"

#include "common/app/standard_streams.hpp"
#include "common/json/json_text.hpp"
#include "server/store/backups.hpp"

#include <boost/json/object.hpp>
#include <fmt/format.h>

#include <iostream>

namespace scanloom::app {

ExitCode restore_store(const ServerOptions& options) {
    const auto restored = store::restore_backup(options.backups, options.backup, options.store);
    if (!restored) {
        standard_error().write(fmt::format("scanloom-server: {}\n", restored.error().message));
        return kExitFailed;
    }
    const boost::json::object summary{{"event", "restored"},
                                      {"id", restored->id},
                                      {"time", restored->time},
                                      {"bytes", restored->bytes},
                                      {"sessions", restored->sessions}};
    std::cout << json_text(summary) << std::endl;
    return kExitDone;
}

} // namespace scanloom::app
