#pragma once

#include <filesystem>

namespace scanloom::fuzz {

/// Writes the fuzzers' seeds in our own formats: a small valid input for each kind of message and record.
/// @param folder  of the corpora, a folder for each fuzzer
void write_corpus(const std::filesystem::path& folder);

} // namespace scanloom::fuzz
