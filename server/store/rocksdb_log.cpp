#include "server/store/rocksdb_log.hpp"

#include <array>
#include <cstdio>

namespace scanloom::store {
namespace {

constexpr std::size_t kLineBytesMax = 1024; // longer lines are cut off

} // namespace

void RocksdbLog::Logv(rocksdb::InfoLogLevel level, const char* format, std::va_list arguments) {
    if (level < GetInfoLogLevel() || !write_) return;
    std::array<char, kLineBytesMax> line{};
    std::vsnprintf(line.data(), line.size(), format, arguments);
    write_(line.data());
}

} // namespace scanloom::store
