#pragma once

#include <rocksdb/db.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>

/// Stores kept in the repository as text: keys and values in hexadecimal, one pair per line, as they were on the disk.
/// Lines that begin with '#' are comments, except "# digest LAYER DIGEST", which gives the expected digest of a layer.
namespace scanloom::store {

inline std::string from_hex(std::string_view text) {
    if (text.size() % 2 != 0) throw std::runtime_error("half a byte in a store's text");
    std::string bytes;
    for (std::size_t at = 0; at < text.size(); at += 2) {
        bytes += static_cast<char>(std::stoi(std::string(text.substr(at, 2)), nullptr, 16));
    }
    return bytes;
}

/// Writes the database described by the text. @return the digests in the form of testing_support::digests_of()
inline std::string write_store(const std::filesystem::path& text, const std::filesystem::path& directory) {
    rocksdb::Options options;
    options.create_if_missing = true;
    options.error_if_exists = true;
    rocksdb::DB* opened = nullptr;
    if (!rocksdb::DB::Open(options, directory.native(), &opened).ok()) throw std::runtime_error("no database");
    const std::unique_ptr<rocksdb::DB> database(opened);
    std::ifstream file(text);
    std::string digests;
    constexpr std::string_view kDigest = "# digest ";
    for (std::string line; std::getline(file, line);) {
        if (line.starts_with(kDigest)) digests += line.substr(kDigest.size()) + "\n";
        if (line.starts_with("#")) continue;
        std::istringstream words(line);
        std::string key;
        std::string value;
        words >> key >> value;
        if (!database->Put({}, from_hex(key), from_hex(value)).ok()) throw std::runtime_error("not stored");
    }
    return digests;
}

} // namespace scanloom::store
