#pragma once

#include "server/store/scan_log.hpp"

#include <functional>
#include <memory>
#include <shared_mutex>
#include <string>
#include <utility>

namespace scanloom::store {

/// Opens the scan log in a directory; open_rocksdb() lists the errors.
using OpenStore = std::function<Result<std::unique_ptr<ScanLog>>(const std::filesystem::path&, const StoreOptions&)>;

/// A scan log that is closed and opened again after a failure.
///
/// After a failed write or sync the disk is in an unknown state, so nothing is retried on the same files: opening reads
/// what is there, as after a crash, and writes it to new files. Until then every change fails and reading continues.
/// While the log is being opened, both fail.
/// Threads: as for ScanLog; append() does not wait for the opening either.
class ReopeningLog final : public ScanLog {
public:
    using Open = std::function<Result<std::unique_ptr<ScanLog>>()>;
    using Check = std::function<Result<>()>;

    /// Opens the log for the first time.
    /// @param disk_is_well  checked before the log is opened again; null: always succeeds
    /// Errors: those of `open`.
    [[nodiscard]] static Result<std::unique_ptr<ReopeningLog>> open(Open open, Check disk_is_well = nullptr);

    /// Sets the function that is called, on the reader's thread, for every log that could not be read to its end, with
    /// kDataLoss or kStoreFailed. Call it before other threads use this object.
    void on_unreadable(std::function<void(SessionId, const Error&)> told) { on_unreadable_ = std::move(told); }

    /// Opens the log again if it has failed and the disk is usable. Waits for readers in progress.
    /// @return whether the log was opened again; if so, every caller of append() has to check where its log ends
    [[nodiscard]] bool try_again();

    [[nodiscard]] Result<SessionId> create_session(std::string_view record) override;
    [[nodiscard]] Result<std::vector<StoredSession>> sessions() override;
    [[nodiscard]] Result<Revision> end_of(SessionId session) override;
    [[nodiscard]] Result<> remove_session(SessionId session) override;
    void append(SessionId session, Revision first, std::vector<std::string> entries, Done done) override;
    [[nodiscard]] Result<> read(SessionId session, Revision after, const VisitEntry& visit) override;
    [[nodiscard]] Result<> clear_checkpoint(SessionId session) override;
    [[nodiscard]] Result<> write_checkpoint(SessionId session, std::vector<CheckpointPart> parts) override;
    [[nodiscard]] Result<> read_checkpoint(SessionId session, const VisitPart& visit) override;

    [[nodiscard]] Result<> copy_with(const CopyDatabase& copy) override;

    /// Returns totals over every time that the log was open.
    [[nodiscard]] StoreStats stats() const override;
    [[nodiscard]] std::uint64_t bytes_on_disk() const override;

private:
    ReopeningLog(std::unique_ptr<ScanLog> log, Open open, Check disk_is_well)
        : open_(std::move(open)), disk_is_well_(std::move(disk_is_well)), log_(std::move(log)) {}

    template <class Use>
    [[nodiscard]] auto use(const Use& what) -> decltype(what(std::declval<ScanLog&>()));
    [[nodiscard]] Error closed() const;

    const Open open_;
    const Check disk_is_well_;
    std::function<void(SessionId, const Error&)> on_unreadable_ = [](SessionId, const Error&) {};
    mutable std::shared_mutex mutex_; // held shared during use of the log
    std::unique_ptr<ScanLog> log_;    // null: it could not be opened again yet
    StoreStats before_;               // of the earlier logs; last_error says why log_ is null
};

/// Opens the store in a directory with `open`. After a failure, opens it again as soon as its disk can be written and
/// has room to open it, and only if its lock file is still the original one. A store that was deleted or replaced is
/// not opened again; that requires a restart.
/// Errors: those of `open`.
[[nodiscard]] Result<std::unique_ptr<ReopeningLog>> open_reopening(const std::filesystem::path& directory,
                                                                   const StoreOptions& options,
                                                                   const OpenStore& open = open_rocksdb);

} // namespace scanloom::store
