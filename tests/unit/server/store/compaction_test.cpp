#include "server/store/rocksdb_store.hpp"

#include "tests/support/log_reading.hpp"
#include "tests/support/temporary_directory.hpp"

#include <gtest/gtest.h>
#include <rocksdb/env.h>
#include <rocksdb/file_system.h>

#include <chrono>
#include <condition_variable>
#include <mutex>

/// Deleting a session frees its disk space.
namespace scanloom::store {
namespace {

/// Notifies a waiting test when the store deletes a file.
class WatchedFileSystem final : public rocksdb::FileSystemWrapper {
public:
    WatchedFileSystem() : FileSystemWrapper(rocksdb::FileSystem::Default()) {}

    const char* Name() const override { return "WatchedFileSystem"; }
    rocksdb::IOStatus DeleteFile(const std::string& name, const rocksdb::IOOptions& options,
                                 rocksdb::IODebugContext* debug) override {
        auto status = target()->DeleteFile(name, options, debug);
        const std::lock_guard lock(mutex_);
        deleted_.notify_all();
        return status;
    }

    /// Waits until the condition holds, and checks it after each deleted file.
    /// @return false if no file was deleted for 20 s
    template <class Condition>
    bool wait_for(const Condition& holds) {
        std::unique_lock lock(mutex_);
        while (!holds()) {
            if (deleted_.wait_for(lock, std::chrono::seconds(20)) == std::cv_status::timeout) return holds();
        }
        return true;
    }

private:
    std::mutex mutex_;
    std::condition_variable deleted_;
};

class FreedDisk : public testing::Test {
protected:
    static constexpr Revision kEntries = 4000; // of 1.5 KB: 6 MB
    static constexpr Revision kPiece = 50;

    FreedDisk() {
        options_.env = env_.get();
        options_.memory_bytes = 1 << 20; // tables of 128 KiB
        log_ = open_rocksdb(directory_.path() / "store", options_).value();
    }

    void append(SessionId session, Revision first) {
        append_and_wait(*log_, session, first, distinct_entries(session, first, kPiece)).value();
    }

    TemporaryDirectory directory_;
    std::shared_ptr<WatchedFileSystem> files_ = std::make_shared<WatchedFileSystem>();
    std::unique_ptr<rocksdb::Env> env_ = rocksdb::NewCompositeEnv(files_);
    StoreOptions options_;
    std::unique_ptr<ScanLog> log_;
};

TEST_F(FreedDisk, RemovingOneOfTwoInterleavedSessionsFreesHalfOfItsBytes) {
    const auto one = log_->create_session("one").value();
    const auto other = log_->create_session("other").value();
    for (Revision first = 1; first <= kEntries; first += kPiece) {
        append(one, first);
        append(other, first);
    }
    std::uint64_t of_one = 0; // bytes of its entries
    for (const auto& entry : distinct_entries(one, 1, kEntries)) of_one += entry.size();
    const auto before = log_->bytes_on_disk();
    ASSERT_TRUE(log_->remove_session(one));
    EXPECT_TRUE(files_->wait_for([&] { return log_->bytes_on_disk() < before - of_one / 10 * 9; }))
        << log_->bytes_on_disk() << " of " << before << " bytes are left";
    EXPECT_EQ(entries_after(*log_, other, 0).value(), distinct_entries(other, 1, kEntries));
}

} // namespace
} // namespace scanloom::store
