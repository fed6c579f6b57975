#pragma once

#include "server/store/scan_log.hpp"

#include <functional>
#include <memory>
#include <shared_mutex>
#include <string>
#include <utility>

namespace scanloom::store {

/// Opens the scan log in a directory; open_rocksdb() has the errors.
using OpenStore = std::function<Result<std::unique_ptr<ScanLog>>(const std::filesystem::path&, const StoreOptions&)>;

/// A scan log that is closed and opened again after it has failed.
///
/// What the disk holds after a failed write or sync is unknown, so that nothing is ever tried again on the same files:
/// opening reads what is there, as after a crash, and writes it to new ones. Until then every change fails, and reading
/// goes on. While it is being opened, both fail.
/// Thread  as ScanLog; append() does not wait for that either.
class ReopeningLog final : public ScanLog {
public:
    using Open = std::function<Result<std::unique_ptr<ScanLog>>()>;
    using Check = std::function<Result<>()>;

    /// Opens it for the first time. `disk_is_well` tells whether it may be worth trying again; null: always.
    /// Errors  those of `open`.
    [[nodiscard]] static Result<std::unique_ptr<ReopeningLog>> open(Open open, Check disk_is_well = nullptr);

    /// Who is told, by the reader's thread, of every log that could not be read to its end: kDataLoss or kStoreFailed.
    /// Call before others use it.
    void on_unreadable(std::function<void(SessionId, const Error&)> told) { on_unreadable_ = std::move(told); }

    /// Where it has failed and the disk is well again: opens it again. Waits for whoever reads.
    /// @return whether it has been opened again: whoever appended has to look where its log ends now.
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

    /// Of all times that it was open.
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
    mutable std::shared_mutex mutex_; // held shared by whoever uses the log
    std::unique_ptr<ScanLog> log_;    // null: it could not be opened again yet
    StoreStats before_;               // of the earlier ones; last_error says why there is none
};

/// Opens the store in a directory with `open`, and again after it has failed: as soon as its disk can be written and
/// has room to open it, and only if its lock file is still the one that was there at first. A
/// store that was deleted or replaced is not opened again; that takes a restart.
/// Errors  those of `open`.
[[nodiscard]] Result<std::unique_ptr<ReopeningLog>> open_reopening(const std::filesystem::path& directory,
                                                                   const StoreOptions& options,
                                                                   const OpenStore& open = open_rocksdb);

} // namespace scanloom::store
