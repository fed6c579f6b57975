#pragma once

#include <rocksdb/env.h>

#include <cstdarg>
#include <functional>
#include <string_view>
#include <utility>

namespace scanloom::store {

/// Passes RocksDB's log lines of level WARN and above to a function.
///
/// RocksDB's own logger writes a file next to the tables, and aborts the process at the first line after one for which
/// the disk had no room.
///
/// Threads: any.
/// Source: RocksDB 7.8, logging/env_logger.h; WritableFileWriter::AssertFalseAndGetStatusForPrevError().
class RocksdbLog final : public rocksdb::Logger {
public:
    using Write = std::function<void(std::string_view line)>;

    /// @param write  called with each line, from threads of RocksDB; null: lines are dropped
    explicit RocksdbLog(Write write) : Logger(rocksdb::InfoLogLevel::WARN_LEVEL), write_(std::move(write)) {}

    using Logger::Logv;
    void Logv(rocksdb::InfoLogLevel level, const char* format, std::va_list arguments) override;

    /// Drops the options that RocksDB lists when a store is opened.
    void LogHeader(const char*, std::va_list) override {}

private:
    const Write write_;
};

} // namespace scanloom::store
