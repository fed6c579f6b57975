#pragma once

#include <filesystem>
#include <fstream>
#include <string_view>

namespace scanloom::fuzz {

/// Writes the seeds of this program's fuzzers that are in our own formats: a small valid input for each kind of message
/// and record.
/// @param folder  of the corpora, a folder for each fuzzer
void write_corpus(const std::filesystem::path& folder);

/// Writes a seed.
/// @param path  of its file, in a folder that may not exist yet
inline void write_file(const std::filesystem::path& path, std::string_view bytes) {
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

} // namespace scanloom::fuzz
