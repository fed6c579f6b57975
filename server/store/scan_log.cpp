#include "server/store/scan_log.hpp"

namespace scanloom::store {

Result<> ScanLog::copy_with(const CopyDatabase&) {
    return Error{Errc::kInvalidField, "this log is not kept on a disk: there is nothing to copy"};
}

} // namespace scanloom::store
