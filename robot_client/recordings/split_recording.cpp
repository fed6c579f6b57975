#include "robot_client/recordings/split_recording.hpp"

#include "robot_client/recordings/recording_lists.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

namespace scanloom::robot {
namespace {

/// A file with a recording.
struct Part {
    std::string name;                    ///< without its digits: a part may have the time when it began in its name
    std::optional<std::uint64_t> number; ///< at the end of its name
    std::filesystem::path path;
};

/// Returns the number at the end of a name: 12 of "drive_12".
std::optional<std::uint64_t> number_of(std::string_view stem) {
    const auto digits = stem.find_last_not_of("0123456789");
    if (digits == std::string_view::npos || stem[digits] != '_') return std::nullopt;
    const auto text = stem.substr(digits + 1);
    std::uint64_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return error == std::errc() ? std::optional(number) : std::nullopt;
}

/// Returns the part that a file is; nullopt: its name is not that of a recording.
std::optional<Part> part_of(const std::filesystem::path& path) {
    std::filesystem::path name = path.filename();
    const auto extension = name.extension();
    if (extension == ".active" || extension == ".zstd") name = name.stem(); // not closed, or compressed
    constexpr std::string_view kExtensions[] = {".bag", ".db3", ".mcap"};
    if (std::ranges::find(kExtensions, name.extension().string()) == std::end(kExtensions)) return std::nullopt;
    const auto stem = name.stem().string();
    std::string letters = stem;
    std::erase_if(letters, [](char c) { return c >= '0' && c <= '9'; });
    return Part{std::move(letters), number_of(stem), path};
}

/// Returns whether sorted files are the parts of one recording, by their names.
bool are_of_one(const std::vector<Part>& parts) {
    const auto differ = [](const Part& a, const Part& b) {
        return a.name != b.name || !a.number || b.number != *a.number + 1;
    };
    return std::ranges::adjacent_find(parts, differ) == parts.end();
}

class SplitRecording final : public Recording {
public:
    /// @param first  the first part, opened
    SplitRecording(std::vector<std::filesystem::path> parts, std::unique_ptr<Recording> first)
        : parts_(std::move(parts)), part_(std::move(first)) {
        for (const auto& path : parts_) {
            std::error_code unknown;
            const auto bytes = std::filesystem::file_size(path, unknown);
            if (!unknown) bytes_total_ += bytes;
        }
    }

    [[nodiscard]] Result<std::optional<RecordedMessage>> next() override {
        while (part_) {
            auto message = part_->next();
            if (!message) return message;
            if (*message) {
                const auto topic = joined_topic((*message)->topic);
                if (!topic) continue;
                (*message)->topic = *topic;
                return message;
            }
            end_part();
        }
        return std::optional<RecordedMessage>();
    }

    [[nodiscard]] const std::vector<RecordedTopic>& topics() const override { return topics_.all(); }
    [[nodiscard]] const std::vector<RecordingLoss>& losses() const override { return losses_.listed(); }
    [[nodiscard]] std::uint64_t losses_count() const override { return losses_.count() + unlisted_; }
    [[nodiscard]] ReadProgress progress() const override {
        const auto bytes = bytes_before_ + (part_ ? part_->progress().bytes : 0);
        return {std::min(bytes, bytes_total_), bytes_total_};
    }

private:
    /// Returns the index in topics() of a topic of the part; nullopt if there are too many topics.
    [[nodiscard]] std::optional<std::size_t> joined_topic(std::size_t topic) {
        while (joined_.size() <= topic) joined_.push_back(topics_.add(part_->topics()[joined_.size()]));
        if (!joined_[topic]) losses_.add(0, "a message of a topic, because there are too many topics");
        return joined_[topic];
    }

    /// Takes the losses of the part, and opens the next one that can be opened.
    void end_part() {
        const auto name = parts_[place_].filename().string();
        for (const auto& loss : part_->losses()) {
            losses_.add(loss.offset, fmt::format("in {}: {}", name, loss.reason));
        }
        unlisted_ += part_->losses_count() - part_->losses().size();
        bytes_before_ += part_->progress().bytes_total;
        part_.reset();
        joined_.clear();
        while (!part_ && ++place_ < parts_.size()) {
            auto opened = open_recording(parts_[place_]);
            if (opened) {
                part_ = std::move(*opened);
            } else {
                losses_.add(0, opened.error().message);
            }
        }
    }

    std::vector<std::filesystem::path> parts_;
    std::unique_ptr<Recording> part_;                // nullptr at the end
    std::size_t place_ = 0;                          // of it in parts_
    std::vector<std::optional<std::size_t>> joined_; // by topic of the part
    TopicList topics_;
    LossList losses_;            // of the parts before
    std::uint64_t unlisted_ = 0; // losses of parts that they do not list
    std::uint64_t bytes_before_ = 0;
    std::uint64_t bytes_total_ = 0;
};

} // namespace

Result<std::vector<std::filesystem::path>> parts_in(const std::filesystem::path& directory) {
    std::vector<Part> parts;
    std::error_code error;
    for (std::filesystem::directory_iterator entry(directory, error), end; !error && entry != end;
         entry.increment(error)) {
        if (auto part = part_of(entry->path())) parts.push_back(std::move(*part));
    }
    if (error) return Error{Errc::kNotFound, fmt::format("{}: {}", directory.string(), error.message())};
    if (parts.empty()) {
        return Error{Errc::kNotFound,
                     fmt::format("{}: a directory without a recording (.bag, .db3, .mcap)", directory.string())};
    }
    std::ranges::sort(parts, {}, [](const Part& part) { return std::pair(part.number, part.path); });
    std::vector<std::filesystem::path> paths;
    for (auto& part : parts) paths.push_back(part.path);
    if (are_of_one(parts)) return paths;
    constexpr std::size_t kShown = 5;
    std::vector<std::string> names;
    for (const auto& path : paths) {
        if (names.size() < kShown) names.push_back(shown_word(path.filename().string()));
    }
    return Error{
        Errc::kInvalidField,
        fmt::format("{}: a directory with {} recordings whose names do not show that they are the parts of one, "
                    "numbered without a gap; name one of them, or move the others away: {}{}",
                    directory.string(), paths.size(), fmt::join(names, ", "), paths.size() > kShown ? ", ..." : "")};
}

Result<std::unique_ptr<Recording>> open_parts(std::vector<std::filesystem::path> parts) {
    auto first = open_recording(parts.front());
    if (!first || parts.size() == 1) return first;
    return std::unique_ptr<Recording>(std::make_unique<SplitRecording>(std::move(parts), std::move(*first)));
}

} // namespace scanloom::robot
