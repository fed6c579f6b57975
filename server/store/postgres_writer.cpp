#include "server/store/postgres_writer.hpp"

#include <utility>

namespace scanloom::store::postgres {
namespace {

bool is_without_effect(Errc code) {
    return code == Errc::kNotFound || code == Errc::kNotOwner || code == Errc::kAlreadyExists ||
           code == Errc::kOverloaded;
}

} // namespace

Result<> Writer::make(const Change& change) {
    const std::lock_guard lock(mutex_);
    if (const auto failure = shared_.failure()) return *failure;
    if (connection_ && !connection_->is_alive()) connection_.reset(); // nothing was under way
    if (!connection_) {
        auto opened = access_.open();
        if (!opened) return shared_.fail(opened.error());
        // A server that is paused within a transaction must not keep others from changing the same rows.
        if (auto set = opened->run("SET idle_in_transaction_session_timeout = 4000"); !set) {
            return shared_.fail(set.error());
        }
        connection_ = std::move(*opened);
    }
    auto changed = change(*connection_);
    if (changed) return changed;
    connection_.reset(); // ends its transaction
    if (is_without_effect(changed.error().code)) return changed;
    return shared_.fail(changed.error());
}

void Writer::close() {
    const std::lock_guard lock(mutex_);
    connection_.reset();
}

} // namespace scanloom::store::postgres
