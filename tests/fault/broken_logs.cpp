#include "tests/fault/broken_logs.hpp"

#include "common/wire/log_codec.hpp"
#include "tests/fault/passing_log.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

namespace scanloom::fault {
namespace {

using store::CheckpointPart;
using store::ScanLog;
using store::SessionId;

class HastyLog final : public PassingLog {
public:
    using PassingLog::PassingLog;

    void append(SessionId session, Revision first, std::vector<std::string> entries, Done done) override {
        {
            const std::lock_guard lock(mutex_);
            kept_back_.push_back({session, first, std::move(entries), nullptr});
            if (kept_back_.size() == kKeptBackMax) write();
        }
        done({});
    }
    Result<> read(SessionId session, Revision after, const VisitEntry& visit) override {
        write_all(); // reads inside this process stay correct
        return PassingLog::read(session, after, visit);
    }
    Result<> write_checkpoint(SessionId session, std::vector<CheckpointPart> parts) override {
        write_all();
        return PassingLog::write_checkpoint(session, std::move(parts));
    }
    [[nodiscard]] bool reopen() override {
        if (!PassingLog::reopen()) return false;
        const std::lock_guard lock(mutex_);
        kept_back_.clear();
        return true;
    }

private:
    static constexpr std::size_t kKeptBackMax = 64;

    void write() {
        for (auto& append : std::exchange(kept_back_, {})) {
            under().append(append.session, append.first, std::move(append.entries), [](const Result<>&) {});
        }
    }
    void write_all() {
        const std::lock_guard lock(mutex_);
        write();
    }

    std::mutex mutex_;
    std::vector<Append> kept_back_; // guarded by mutex_
};

class ForgetfulLog final : public PassingLog {
public:
    using PassingLog::PassingLog;

    void append(SessionId session, Revision first, std::vector<std::string> entries, Done done) override {
        const std::lock_guard lock(mutex_); // held until the append, so that appends keep their order
        std::uint64_t& ahead = ahead_[session];
        if (!are_scans(entries) || ++appends_ % kForgetsEvery != 0) {
            return under().append(session, first + ahead, std::move(entries), std::move(done));
        }
        const Revision again = first + ahead + entries.size();
        under().append(session, first + ahead, entries, [](const Result<>&) {});
        ahead += entries.size();
        under().append(session, again, std::move(entries), std::move(done));
    }
    [[nodiscard]] bool reopen() override {
        if (!PassingLog::reopen()) return false;
        const std::lock_guard lock(mutex_);
        ahead_.clear();
        return true;
    }

private:
    static constexpr std::uint64_t kForgetsEvery = 8;

    static bool are_scans(const std::vector<std::string>& entries) {
        return std::ranges::all_of(entries, [](const std::string& bytes) {
            const auto entry = wire::decode_entry(bytes);
            return entry && std::holds_alternative<ScanTaken>(*entry);
        });
    }

    std::mutex mutex_;                         // guards the members below
    std::uint64_t appends_ = 0;                // appended scans
    std::map<SessionId, std::uint64_t> ahead_; // entries that the session has no record of
};

class BlindLog final : public PassingLog {
public:
    using PassingLog::PassingLog;

    Result<> read(SessionId session, Revision after, const VisitEntry& visit) override {
        return PassingLog::read(session, after, [&](Revision revision, std::string_view bytes) -> store::Visited {
            auto entry = wire::decode_entry(bytes);
            auto* taken = entry ? std::get_if<ScanTaken>(&*entry) : nullptr;
            if (taken == nullptr || revision % kSpoilsEvery != 0) return visit(revision, bytes);
            taken->scan.ranges.front() ^= 1;
            return visit(revision, wire::encode_entry(*entry));
        });
    }
    Result<> read_checkpoint(SessionId, const VisitPart&) override { return {}; } // forces a full read of the log

private:
    static constexpr Revision kSpoilsEvery = 50;
};

class MisledLog final : public PassingLog {
public:
    using PassingLog::PassingLog;

    void append(SessionId session, Revision first, std::vector<std::string> entries, Done done) override {
        if (Clock::now() < opened_) return done({});
        PassingLog::append(session, first, std::move(entries), std::move(done));
    }

private:
    using Clock = std::chrono::system_clock;
    const Clock::time_point opened_ = Clock::now();
};

class LeakyLog final : public PassingLog {
public:
    using PassingLog::PassingLog;

    void append(SessionId session, Revision first, std::vector<std::string> entries, Done done) override {
        {
            const std::lock_guard lock(mutex_);
            leaked_.emplace_back(entries.size() * kBytesOfEntry, 'x');
        }
        PassingLog::append(session, first, std::move(entries), std::move(done));
    }

private:
    static constexpr std::size_t kBytesOfEntry = 65'536;

    std::mutex mutex_;
    std::vector<std::string> leaked_; // guarded by mutex_
};

class TiringLog final : public PassingLog {
public:
    using PassingLog::PassingLog;

    void append(SessionId session, Revision first, std::vector<std::string> entries, Done done) override {
        if ((taken_ += entries.size()) <= kTakenFresh) {
            return PassingLog::append(session, first, std::move(entries), std::move(done));
        }
        // Adds latency without reducing throughput: appends made while one waits are stored together and complete no
        // later than their own delay.
        const auto when = Clock::now() + kLateness;
        PassingLog::append(session, first, std::move(entries), [when, done = std::move(done)](Result<> appended) {
            boost::asio::io_context io;
            boost::asio::steady_timer(io, when).wait();
            done(std::move(appended));
        });
    }

private:
    using Clock = std::chrono::steady_clock;
    static constexpr std::size_t kTakenFresh = 800; // 20 robots at 10 Hz for 3 s send fewer
    static constexpr std::chrono::seconds kLateness{2};

    std::atomic<std::size_t> taken_ = 0;
};

} // namespace

std::unique_ptr<ScanLog> hasty_log(std::unique_ptr<ScanLog> log) { return std::make_unique<HastyLog>(std::move(log)); }

std::unique_ptr<ScanLog> forgetful_log(std::unique_ptr<ScanLog> log) {
    return std::make_unique<ForgetfulLog>(std::move(log));
}

std::unique_ptr<ScanLog> blind_log(std::unique_ptr<ScanLog> log) { return std::make_unique<BlindLog>(std::move(log)); }

std::unique_ptr<ScanLog> misled_log(std::unique_ptr<ScanLog> log) {
    return std::make_unique<MisledLog>(std::move(log));
}

std::unique_ptr<ScanLog> leaky_log(std::unique_ptr<ScanLog> log) { return std::make_unique<LeakyLog>(std::move(log)); }

std::unique_ptr<ScanLog> tiring_log(std::unique_ptr<ScanLog> log) {
    return std::make_unique<TiringLog>(std::move(log));
}

std::unique_ptr<ScanLog> broken_log(std::string_view kind, std::unique_ptr<ScanLog> log) {
    if (kind == "hasty") return hasty_log(std::move(log));
    if (kind == "forgetful") return forgetful_log(std::move(log));
    if (kind == "blind") return blind_log(std::move(log));
    if (kind == "misled") return misled_log(std::move(log));
    if (kind == "leaky") return leaky_log(std::move(log));
    if (kind == "tiring") return tiring_log(std::move(log));
    return log;
}

} // namespace scanloom::fault
