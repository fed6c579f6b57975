#pragma once

#include "robot_client/source/unpacking.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

namespace scanloom::robot {

/// The bytes of a file, plain or unpacked from gzip or bzip2. Zero bytes behind packed data are padding, as archives
/// and tapes leave it.
///
/// Thread  one at a time.
class UnpackedFile {
public:
    /// Opens it; is_open() tells whether that went well, errno why not.
    explicit UnpackedFile(const std::filesystem::path& path);

    [[nodiscard]] bool is_open() const { return file_.is_open(); }
    [[nodiscard]] Packing packing() const noexcept { return packing_; }

    /// Fills `text`, which is not empty, from its begin on. @return how many bytes there were, 0 at the end; nothing
    /// where the packed data are damaged or cut short. What stands before the damage comes first.
    [[nodiscard]] std::optional<std::size_t> read(std::span<char> text);

    /// Bytes of the file, packed as it is.
    [[nodiscard]] std::uint64_t bytes_read() const noexcept { return bytes_read_; }

    /// True when the end came because the file could not be read on.
    [[nodiscard]] bool has_failed() const { return file_.bad(); }

private:
    void refill();
    [[nodiscard]] std::size_t read_plain(std::span<char> text);
    [[nodiscard]] bool only_zeros_are_left();

    std::ifstream file_;
    std::array<char, 16384> buffer_{};
    std::string_view packed_; ///< what is left of the buffer
    Packing packing_ = Packing::kPlain;
    std::unique_ptr<MemberUnpacker> member_; ///< none between two members
    std::uint64_t bytes_read_ = 0;
    bool is_first_member_ = true;
    bool is_damaged_ = false;
};

} // namespace scanloom::robot
