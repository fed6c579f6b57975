#include "server/store/postgres_size_limit.hpp"

#include <fmt/format.h>

namespace scanloom::store::postgres {
namespace {

// A size that was asked for is used this long.
constexpr std::chrono::seconds kAge{10};
constexpr std::chrono::milliseconds kFullAge{100}; // while the limit is reached: sessions may have been removed

} // namespace

Result<> SizeLimit::check(Connection& connection) {
    if (!bytes_max_) return {};
    const auto now = Clock::now();
    const std::lock_guard lock(mutex_);
    const bool is_known = asked_ && now - *asked_ < (bytes_ < *bytes_max_ ? Clock::duration(kAge) : kFullAge);
    if (!is_known) {
        const auto rows =
            connection.run("SELECT coalesce(sum(entry_bytes + checkpoint_bytes), 0)::bigint FROM scanloom.session", {},
                           Connection::kReadTimeout);
        if (!rows) return rows.error();
        bytes_ = static_cast<std::uint64_t>(rows->number(0, 0));
        asked_ = now;
    }
    if (bytes_ < *bytes_max_) return {};
    return Error{Errc::kOverloaded,
                 fmt::format("the store has {} MiB, and --store-size-max is {} MiB; remove sessions, or "
                             "raise the limit if the disk of the database has room",
                             bytes_ >> 20, *bytes_max_ >> 20)};
}

void SizeLimit::add(std::uint64_t bytes) {
    const std::lock_guard lock(mutex_);
    bytes_ += bytes;
}

} // namespace scanloom::store::postgres
