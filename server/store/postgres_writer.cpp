#include "server/store/postgres_writer.hpp"

#include <utility>

namespace scanloom::store::postgres {

Result<> Writer::make(const Change& change) {
    const std::lock_guard lock(mutex_);
    if (const auto failure = shared_.failure()) return *failure;
    if (connection_ && !connection_->is_alive()) connection_.reset(); // nothing was under way
    if (!connection_) {
        auto opened = Connection::open(place_);
        if (!opened) return shared_.fail(opened.error());
        connection_ = std::move(*opened);
    }
    auto changed = change(*connection_);
    if (changed) return changed;
    connection_.reset(); // ends its transaction
    if (changed.error().code == Errc::kNotFound || changed.error().code == Errc::kOverloaded) return changed;
    return shared_.fail(changed.error());
}

void Writer::close() {
    const std::lock_guard lock(mutex_);
    connection_.reset();
}

} // namespace scanloom::store::postgres
