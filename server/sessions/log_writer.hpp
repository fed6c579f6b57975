#pragma once

#include "common/wire/log_codec.hpp"
#include "server/store/scan_log.hpp"

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace scanloom::sessions {

/// Appends entries to an empty log in pieces, and waits for each piece.
/// Threads: one at a time, which may wait for the disk.
class LogWriter {
public:
    /// @param log      must outlive this object
    /// @param session  whose log is empty
    LogWriter(store::ScanLog& log, store::SessionId session) : log_(log), session_(session) {}

    /// Adds the next entry.
    /// Errors: those of ScanLog::append(), for this entry or earlier ones.
    [[nodiscard]] Result<> add(const LogEntry& entry) {
        entries_.push_back(wire::encode_entry(entry));
        bytes_ += entries_.back().size();
        return bytes_ < kPieceBytes ? Result<>{} : write();
    }

    /// Makes all added entries durable.
    /// Errors: those of ScanLog::append().
    [[nodiscard]] Result<> write() {
        if (entries_.empty()) return {};
        const Revision first = end_ + 1;
        end_ += entries_.size();
        bytes_ = 0;
        return store::append_and_wait(log_, session_, first, std::exchange(entries_, {}));
    }

    /// Returns the revision of the newest added entry.
    [[nodiscard]] Revision end() const noexcept { return end_ + entries_.size(); }

private:
    static constexpr std::size_t kPieceBytes = std::size_t{1} << 20;

    store::ScanLog& log_;
    const store::SessionId session_;
    std::vector<std::string> entries_;
    std::size_t bytes_ = 0;
    Revision end_ = 0;
};

} // namespace scanloom::sessions
