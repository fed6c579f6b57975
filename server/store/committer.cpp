#include "server/store/committer.hpp"

#include <fmt/format.h>

#include <cassert>
#include <future>
#include <utility>

namespace scanloom::store {
namespace {

// A larger group would delay a write's first change without saving a noticeable part of an fsync.
constexpr std::uint64_t kGroupBytesMax = std::uint64_t{8} << 20;

} // namespace

Committer::Committer(rocksdb::DB& database, std::string name, std::uint64_t disk_reserve_bytes,
                     CompactionSwitch& compactions, FilesWatch* files)
    : database_(database), name_(std::move(name)), disk_reserve_bytes_(disk_reserve_bytes), compactions_(compactions),
      files_(files), thread_([this] { run(); }) {}

Committer::~Committer() {
    {
        const std::lock_guard lock(mutex_);
        stopping_ = true;
    }
    waiting_.notify_one();
    thread_.join();
    check_files(); // closing a database deletes files
}

void Committer::submit(Change change) {
    {
        const std::lock_guard lock(mutex_);
        stats_.queued_bytes += change.bytes;
        queue_.push_back(std::move(change));
    }
    waiting_.notify_one();
}

Result<> Committer::submit_and_wait(Change change) {
    assert(std::this_thread::get_id() != thread_.get_id());
    // Shared, because set_value() may still be returning when the waiting thread continues.
    const auto outcome = std::make_shared<std::promise<Result<>>>();
    auto result_of_change = outcome->get_future();
    change.done = [outcome](Result<> result) { outcome->set_value(std::move(result)); };
    submit(std::move(change));
    return result_of_change.get();
}

StoreStats Committer::stats() const {
    std::unique_lock lock(mutex_);
    StoreStats stats = stats_;
    lock.unlock();
    if (files_ != nullptr) {
        if (const auto in_place = files_->check(); !in_place) stats.last_error = in_place.error().message;
    }
    if (!stats.no_room) return stats;
    const auto no_room = shortage(free_bytes()); // as of now
    stats.no_room = no_room ? std::optional(no_room->message) : std::nullopt;
    return stats;
}

/// Takes about a microsecond.
std::optional<std::uint64_t> Committer::free_bytes() const {
    std::uint64_t free = 0;
    if (!database_.GetEnv()->GetFreeSpace(name_, &free).ok()) return std::nullopt;
    return free;
}

std::optional<Error> Committer::shortage(std::optional<std::uint64_t> free) const {
    if (!free || *free >= disk_reserve_bytes_) return std::nullopt;
    return Error{Errc::kOverloaded,
                 fmt::format("the disk of the store {} has {} MiB left, of which {} are kept free: nothing more is "
                             "stored; free some space, or delete sessions",
                             name_, *free >> 20, disk_reserve_bytes_ >> 20)};
}

void Committer::run() {
    for (Group group = next_group(); !group.empty(); group = next_group()) commit(std::move(group));
}

/// Waits for changes. Returns an empty group when the committer stops.
Committer::Group Committer::next_group() {
    std::unique_lock lock(mutex_);
    waiting_.wait(lock, [this] { return stopping_ || !queue_.empty(); });
    Group group;
    std::uint64_t bytes = 0;
    while (!queue_.empty() && (group.empty() || bytes + queue_.front().bytes <= kGroupBytesMax)) {
        bytes += queue_.front().bytes;
        group.push_back(std::move(queue_.front()));
        queue_.pop_front();
    }
    stats_.queued_bytes -= bytes;
    return group;
}

void Committer::commit(Group group) {
    std::uint64_t bytes = 0;
    for (const Change& change : group) bytes += change.bytes;
    rocksdb::WriteBatch batch(static_cast<std::size_t>(bytes)); // reserved, so that it need not grow
    std::vector<Result<>> results;
    results.reserve(group.size());
    check_files();
    const auto free = free_bytes();
    if (free && !failed_) compactions_.update(*free);
    const auto no_room = shortage(free);
    {
        const std::lock_guard lock(mutex_);
        stats_.no_room = no_room ? std::optional(no_room->message) : std::nullopt;
    }
    for (const Change& change : group) {
        if (failed_) {
            results.emplace_back(*failed_);
        } else if (no_room && !change.frees_disk) {
            results.emplace_back(*no_room);
        } else {
            results.push_back(change.add_to(batch));
        }
    }
    if (batch.Count() > 0) {
        const auto written = write(batch);
        for (auto& result : results) {
            if (result) result = written;
        }
    }
    for (std::size_t i = 0; i < group.size(); ++i) {
        if (results[i]) count(group[i]);
        group[i].done(std::move(results[i]));
    }
}

Result<> Committer::write(rocksdb::WriteBatch& batch) {
    rocksdb::WriteOptions options;
    options.sync = true;
    const auto status = database_.Write(options, &batch);
    if (!status.ok()) {
        fail({Errc::kStoreFailed,
              fmt::format(
                  "the store {} could not write ({}); it accepts no changes until it is reopened, which the server "
                  "does as soon as its disk can be written",
                  name_, status.ToString())});
    }
    check_files(); // acknowledges nothing that went to deleted files
    if (failed_) return *failed_;
    const std::lock_guard lock(mutex_);
    ++stats_.synced_writes;
    return {};
}

void Committer::check_files() {
    if (files_ == nullptr) return;
    if (auto in_place = files_->check(); !in_place) fail(in_place.error());
}

void Committer::fail(Error why) {
    const std::lock_guard lock(mutex_);
    stats_.last_error = why.message;
    failed_ = std::move(why);
}

void Committer::count(const Change& change) {
    const std::lock_guard lock(mutex_);
    stats_.appends += change.appends;
    stats_.entries += change.entries;
}

} // namespace scanloom::store
