#include "tests/fault/store_damage.hpp"

#include "tests/support/store_files.hpp"

#include <boost/endian/conversion.hpp>
#include <fmt/format.h>

#include <algorithm>

namespace scanloom::fault {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kSectorBytes = 512;

/// Returns the store's non-empty files by name, without the lock file and RocksDB's text log (LOG).
std::vector<fs::path> files_of(const fs::path& store) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(store)) {
        const std::string name = entry.path().filename().string();
        if (entry.is_regular_file() && entry.file_size() > 0 && !name.starts_with("LO")) files.push_back(entry.path());
    }
    std::ranges::sort(files);
    return files;
}

bool has_records(const fs::path& file) {
    return file.extension() == ".log" || file.filename().string().starts_with("MANIFEST");
}

/// Returns a position in a file: in half of the cases at or just after the border of two records, if the file has any.
std::size_t some_place(const fs::path& file, const std::string& bytes, std::mt19937_64& random) {
    constexpr std::size_t kHeaderBytes = 7;
    const auto borders = has_records(file) ? record_borders(bytes) : std::vector<std::size_t>{};
    if (borders.empty() || random() % 2 == 0) return random() % bytes.size();
    return std::min(borders[random() % borders.size()] + random() % kHeaderBytes, bytes.size() - 1);
}

} // namespace

std::vector<std::size_t> record_borders(std::string_view bytes) {
    constexpr std::size_t kBlockBytes = 32768, kHeaderBytes = 7;
    std::vector<std::size_t> borders;
    for (std::size_t at = 0; at + kHeaderBytes <= bytes.size();) {
        if (kBlockBytes - at % kBlockBytes < kHeaderBytes) { // too short for a record, so the next block begins
            at += kBlockBytes - at % kBlockBytes;
            continue;
        }
        borders.push_back(at);
        at += kHeaderBytes +
              boost::endian::load_little_u16(reinterpret_cast<const unsigned char*>(bytes.data()) + at + 4);
    }
    return borders;
}

std::string damage(const fs::path& store, std::mt19937_64& random) {
    const auto files = files_of(store);
    const fs::path& file = files[random() % files.size()];
    const std::string name = file.filename().string();
    std::string bytes = store::bytes_of(file);
    const std::size_t at = some_place(file, bytes, random);
    switch (random() % 8) {
    case 0: fs::remove(file); return fmt::format("{} was removed", name);
    case 1: {
        const fs::path& other = files[random() % files.size()];
        const std::string others = store::bytes_of(other);
        store::write_bytes(other, bytes);
        store::write_bytes(file, others);
        return fmt::format("{} and {} were exchanged", name, other.filename().string());
    }
    case 2:
    case 3: fs::resize_file(file, at); return fmt::format("{} ends after {} of {} bytes", name, at, bytes.size());
    case 4: {
        const std::size_t begin = at - at % kSectorBytes;
        const std::size_t end = std::min(begin + kSectorBytes, bytes.size());
        std::fill(bytes.begin() + static_cast<std::ptrdiff_t>(begin), bytes.begin() + static_cast<std::ptrdiff_t>(end),
                  '\0');
        store::write_bytes(file, bytes);
        return fmt::format("{} is zero from byte {} to {}", name, begin, end);
    }
    default: {
        const unsigned bit = random() % 8;
        store::flip_bit(file, at, bit);
        return fmt::format("bit {} of byte {} of {} in {} is flipped", bit, at, bytes.size(), name);
    }
    }
}

} // namespace scanloom::fault
