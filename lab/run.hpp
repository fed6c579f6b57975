#pragma once

#include "common/error/error.hpp"
#include "lab/options.hpp"

#include <filesystem>
#include <span>
#include <string_view>

namespace scanloom::lab {

/// A directory for results.
class OutputDirectory {
public:
    /// Opens the directory; creates it and its parents if needed.
    /// Errors: kStoreFailed: it cannot be created.
    [[nodiscard]] static Result<OutputDirectory> open(const std::filesystem::path& path);

    /// Writes a file; replaces an older one of the same name.
    /// Errors: kStoreFailed: the file could not be written completely.
    [[nodiscard]] Result<> write(const std::filesystem::path& file, std::string_view content) const;
    [[nodiscard]] Result<> write(const std::filesystem::path& file, std::span<const std::uint8_t> content) const;

    [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

private:
    explicit OutputDirectory(std::filesystem::path path) : path_(std::move(path)) {}

    std::filesystem::path path_;
};

/// Runs the chosen experiment. Progress and errors go to stderr, one line of JSON about the result to stdout.
[[nodiscard]] ExitCode run(const ExperimentOptions& options);
[[nodiscard]] ExitCode run(const LandmarkOptions& options);
[[nodiscard]] ExitCode run(const ScoreOptions& options);
[[nodiscard]] ExitCode run(const LocalizationOptions& options);
[[nodiscard]] ExitCode run(const cluster::Plan& plan);

} // namespace scanloom::lab
