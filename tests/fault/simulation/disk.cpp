#include "tests/fault/simulation/disk.hpp"

#include <utility>

namespace scanloom::simulation {
namespace {

using namespace std::chrono_literals;

Error gone() { return {Errc::kStoreFailed, "the program that had the store open is gone"}; }
Error closed() { return {Errc::kStoreFailed, "the store is closed, because it could not be reopened yet"}; }
Error full() { return {Errc::kOverloaded, "the disk has no room"}; }

} // namespace

/// The store while a program has it open.
class Disk::OpenLog final : public store::ScanLog {
public:
    explicit OpenLog(Disk& disk) : disk_(disk), program_(disk.programs_) {}
    ~OpenLog() override {
        if (is_alive() && !disk_.waiting_.empty()) disk_.commit();
    }

    Result<store::SessionId> create_session(std::string_view record) override {
        if (auto settled = settle(true); !settled) return settled.error();
        return disk_.durable_.create_session(record);
    }
    Result<std::vector<store::StoredSession>> sessions() override {
        if (disk_.is_closed_) return closed();
        return disk_.durable_.sessions();
    }
    Result<Revision> end_of(store::SessionId session) override {
        if (disk_.is_closed_) return closed();
        return disk_.durable_.end_of(session);
    }
    Result<> remove_session(store::SessionId session) override {
        if (auto settled = settle(false); !settled) return settled;
        return disk_.durable_.remove_session(session);
    }
    void append(store::SessionId session, Revision first, std::vector<std::string> entries, Done done) override {
        if (!is_alive()) return done(gone());
        disk_.add({session, first, std::move(entries), std::move(done)});
    }
    Result<> read(store::SessionId session, Revision after, const VisitEntry& visit) override {
        if (disk_.is_closed_) return closed();
        return disk_.durable_.read(session, after, visit);
    }
    Result<> clear_checkpoint(store::SessionId session) override {
        if (auto settled = settle(false); !settled) return settled;
        return disk_.durable_.clear_checkpoint(session);
    }
    Result<> write_checkpoint(store::SessionId session, std::vector<store::CheckpointPart> parts) override {
        if (auto settled = settle(true); !settled) return settled;
        return disk_.durable_.write_checkpoint(session, std::move(parts));
    }
    Result<> read_checkpoint(store::SessionId session, const VisitPart& visit) override {
        if (disk_.is_closed_) return closed();
        return disk_.durable_.read_checkpoint(session, visit);
    }
    bool reopen() override {
        if (!is_alive() || !disk_.failed_) return false;
        if (!disk_.waiting_.empty()) disk_.commit();
        return disk_.try_to_open();
    }
    store::StoreStats stats() const override {
        store::StoreStats stats;
        if (disk_.failed_) stats.last_error = disk_.failed_->message;
        return stats;
    }
    std::uint64_t bytes_on_disk() const override { return 0; }

private:
    [[nodiscard]] bool is_alive() const { return program_ == disk_.programs_; }
    [[nodiscard]] Result<> settle(bool adds) { return is_alive() ? disk_.settle(adds) : Result<>(gone()); }

    Disk& disk_;
    const std::uint64_t program_;
};

Result<std::unique_ptr<store::ScanLog>> Disk::open() {
    if (!try_to_open()) return Error{Errc::kStoreFailed, "the disk cannot be read"};
    ++programs_;
    return std::make_unique<OpenLog>(*this);
}

/// Returns false at random, and then the store is closed.
bool Disk::try_to_open() {
    is_closed_ = world_.chance(trouble_.failing);
    if (!is_closed_) failed_.reset();
    return !is_closed_;
}

void Disk::crash() {
    ++programs_;
    committing_ = 0;
    const std::uint64_t reached = trouble_.hasty || failed_ ? 0 : world_.draw(waiting_.size() + 1);
    auto waiting = std::exchange(waiting_, {});
    for (std::uint64_t n = 0; n < waiting.size(); ++n) {
        const auto done = std::exchange(waiting[n].done, [](const Result<>&) {});
        n < reached ? store(waiting[n]) : drop(waiting[n]);
        done(gone());
    }
    failed_.reset();
}

void Disk::add(Append append) {
    if (trouble_.hasty) std::exchange(append.done, [](const Result<>&) {})({});
    waiting_.push_back(std::move(append));
    if (at_once_) return commit();
    if (committing_ != 0) return;
    const bool slow = world_.chance(trouble_.slow);
    const Duration latest = trouble_.hasty ? Duration(2s) : Duration(5ms);
    committing_ = ++commits_;
    world_.after(slow ? world_.between(1s, 20s) : world_.between(50us, latest), [this, number = committing_] {
        if (committing_ == number) commit();
    });
}

/// Writes all waiting appends of all sessions with one write.
void Disk::commit() {
    committing_ = 0;
    if (!failed_ && world_.chance(trouble_.failing)) return fail({Errc::kStoreFailed, "a write failed"});
    if (world_.chance(trouble_.full)) full_until_ = world_.now() + world_.between(100ms, 5s);
    const bool is_full = world_.now() < full_until_;
    for (auto& append : std::exchange(waiting_, {})) {
        if (!failed_ && !is_full) {
            store(append);
        } else {
            drop(append);
            append.done(failed_ ? *failed_ : full());
        }
    }
}

void Disk::store(Append& append) {
    const auto end = durable_.end_of(append.session);
    if (!end || *end + 1 != append.first) drop(append); // the real log also refuses it, as its predecessor was dropped
    world_.note("stored", append.first + append.entries.size());
    const auto again = append.entries;
    durable_.append(append.session, append.first, std::move(append.entries), std::move(append.done));
    if (!trouble_.forgetful || !world_.chance(0.1)) return;
    durable_.append(append.session, append.first + again.size(), again, [](const Result<>&) {});
}

/// Marks an append as not stored, although a hasty disk may have acknowledged it.
void Disk::drop(Append& append) {
    if (trouble_.hasty) dropped_.push_back({append.session, append.entries});
}

/// Stores some of the waiting appends; the callers do not learn which.
void Disk::fail(const Error& why) {
    world_.note("failed");
    const std::uint64_t reached = world_.draw(waiting_.size() + 1);
    for (std::uint64_t n = 0; n < waiting_.size(); ++n) {
        auto done = std::exchange(waiting_[n].done, [](const Result<>&) {});
        n < reached ? store(waiting_[n]) : drop(waiting_[n]);
        done(why);
    }
    waiting_.clear();
    failed_ = why;
}

/// Writes waiting appends first. `adds`: the change needs additional space.
Result<> Disk::settle(bool adds) {
    if (!waiting_.empty()) commit();
    if (!failed_ && world_.chance(trouble_.failing)) failed_ = Error{Errc::kStoreFailed, "a write failed"};
    if (failed_) return *failed_;
    if (adds && world_.now() < full_until_) return full();
    return {};
}

void Disk::set_at_once(bool at_once) {
    at_once_ = at_once;
    if (at_once && !waiting_.empty()) commit();
}

} // namespace scanloom::simulation
