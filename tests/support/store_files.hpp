#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

/// Functions for tests that damage a store's files.
namespace scanloom::store {

inline std::string bytes_of(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

inline void write_bytes(const std::filesystem::path& file, std::string_view bytes) {
    std::ofstream(file, std::ios::binary) << bytes;
}

inline void flip_bit(const std::filesystem::path& file, std::size_t byte, unsigned bit) {
    std::string bytes = bytes_of(file);
    bytes.at(byte) = static_cast<char>(bytes.at(byte) ^ (1 << bit));
    write_bytes(file, bytes);
}

/// Returns the contents of each file of a directory, by name.
inline std::map<std::string, std::string> files_in(const std::filesystem::path& directory) {
    std::map<std::string, std::string> files;
    for (const auto& file : std::filesystem::directory_iterator(directory)) {
        files.emplace(file.path().filename().native(), bytes_of(file.path()));
    }
    return files;
}

/// Returns the files whose names begin or end with `pattern`, sorted by name.
inline std::vector<std::filesystem::path> files_like(const std::filesystem::path& directory, std::string_view pattern) {
    std::vector<std::filesystem::path> found;
    for (const auto& file : std::filesystem::directory_iterator(directory)) {
        const std::string name = file.path().filename().native();
        if (name.starts_with(pattern) || name.ends_with(pattern)) found.push_back(file.path());
    }
    std::sort(found.begin(), found.end());
    return found;
}

inline std::filesystem::path only_file_like(const std::filesystem::path& directory, std::string_view pattern) {
    const auto found = files_like(directory, pattern);
    if (found.size() != 1) throw std::runtime_error("not one file like " + std::string(pattern));
    return found.front();
}

/// Returns the size of each file of a directory, by name.
inline std::map<std::string, std::uintmax_t> sizes_in(const std::filesystem::path& directory) {
    std::map<std::string, std::uintmax_t> sizes;
    for (const auto& file : std::filesystem::directory_iterator(directory)) {
        std::error_code removed;
        sizes.emplace(file.path().filename().native(), std::filesystem::file_size(file.path(), removed));
    }
    return sizes;
}

/// Copies the files of an open store, as kill -9 would leave them. Precondition: no caller writes to the store. The
/// store itself may merge tables in the background, so the copy is repeated until no file changes during it.
inline void copy_store(const std::filesystem::path& from, const std::filesystem::path& to) {
    for (;;) {
        std::filesystem::remove_all(to);
        const auto before = sizes_in(from);
        std::error_code merged;
        std::filesystem::copy(from, to, merged);
        if (!merged && sizes_in(from) == before && sizes_in(to) == before) return;
    }
}

} // namespace scanloom::store
