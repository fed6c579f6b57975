#include "robot_client/source/unpacked_file.hpp"

#include <algorithm>

namespace scanloom::robot {

UnpackedFile::UnpackedFile(const std::filesystem::path& path) : file_(path, std::ios::binary) {
    std::array<char, 3> first_bytes{};
    file_.read(first_bytes.data(), first_bytes.size());
    packing_ = packing_of({first_bytes.data(), static_cast<std::size_t>(file_.gcount())});
    file_.clear();
    file_.seekg(0);
}

std::optional<std::size_t> UnpackedFile::read(std::span<char> text) {
    if (packing_ == Packing::kPlain) return read_plain(text);
    while (!is_damaged_) {
        if (packed_.empty()) refill();
        if (!member_) {
            if (packed_.empty()) return 0;
            if (!is_first_member_ && packed_.front() == '\0') {
                is_damaged_ = !only_zeros_are_left();
                continue;
            }
            member_ = unpacker_of(packing_);
            is_first_member_ = false;
        }
        const Unpacked step = member_->step(packed_, text);
        packed_.remove_prefix(step.taken);
        const bool is_cut_short = step.taken == 0 && step.made == 0; // it needs more input and there is none
        is_damaged_ =
            step.state == Unpacked::State::kDamaged || (step.state == Unpacked::State::kGoesOn && is_cut_short);
        if (step.state == Unpacked::State::kEnded) member_.reset();
        if (step.made > 0) return step.made;
    }
    return std::nullopt;
}

void UnpackedFile::refill() {
    file_.read(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
    packed_ = std::string_view(buffer_.data(), static_cast<std::size_t>(file_.gcount()));
    bytes_read_ += packed_.size();
}

std::size_t UnpackedFile::read_plain(std::span<char> text) {
    if (packed_.empty()) refill();
    const std::size_t count = packed_.copy(text.data(), text.size());
    packed_.remove_prefix(count);
    return count;
}

bool UnpackedFile::only_zeros_are_left() {
    while (!packed_.empty()) {
        if (std::ranges::any_of(packed_, [](char byte) { return byte != '\0'; })) return false;
        refill();
    }
    return true;
}

} // namespace scanloom::robot
