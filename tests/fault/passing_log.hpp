#pragma once

#include "server/store/scan_log.hpp"

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace scanloom::fault {

/// Forwards all calls.
class PassingLog : public store::ScanLog {
public:
    explicit PassingLog(std::unique_ptr<store::ScanLog> log) : log_(std::move(log)) {}

    Result<store::SessionId> create_session(std::string_view record) override { return log_->create_session(record); }
    Result<std::vector<store::StoredSession>> sessions() override { return log_->sessions(); }
    Result<Revision> end_of(store::SessionId session) override { return log_->end_of(session); }
    Result<> remove_session(store::SessionId session) override { return log_->remove_session(session); }
    void append(store::SessionId session, Revision first, std::vector<std::string> entries, Done done) override {
        log_->append(session, first, std::move(entries), std::move(done));
    }
    Result<> read(store::SessionId session, Revision after, const VisitEntry& visit) override {
        return log_->read(session, after, visit);
    }
    Result<> clear_checkpoint(store::SessionId session) override { return log_->clear_checkpoint(session); }
    Result<> write_checkpoint(store::SessionId session, std::vector<store::CheckpointPart> parts) override {
        return log_->write_checkpoint(session, std::move(parts));
    }
    Result<> read_checkpoint(store::SessionId session, const VisitPart& visit) override {
        return log_->read_checkpoint(session, visit);
    }
    [[nodiscard]] bool reopen() override { return log_->reopen(); }
    [[nodiscard]] store::StoreStats stats() const override { return log_->stats(); }
    [[nodiscard]] std::uint64_t bytes_on_disk() const override { return log_->bytes_on_disk(); }
    [[nodiscard]] store::SharedSessions* shared() override { return log_->shared(); }

protected:
    /// The arguments of append().
    struct Append {
        store::SessionId session;
        Revision first;
        std::vector<std::string> entries;
        Done done;
    };

    [[nodiscard]] store::ScanLog& under() { return *log_; }

private:
    std::unique_ptr<store::ScanLog> log_;
};

} // namespace scanloom::fault
