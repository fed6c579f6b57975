#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
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

/// Copies the files of an open but idle store, which is the state that kill -9 would leave.
inline void copy_store(const std::filesystem::path& from, const std::filesystem::path& to) {
    std::filesystem::remove_all(to);
    std::filesystem::copy(from, to);
}

} // namespace scanloom::store
