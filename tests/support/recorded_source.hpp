#pragma once

#include "robot_client/sources/source.hpp"

#include <vector>

namespace scanloom::robot {

/// A source that returns observations from memory.
class RecordedSource final : public Source {
public:
    explicit RecordedSource(std::vector<Observation> observations) : observations_(std::move(observations)) {}

    [[nodiscard]] Result<std::optional<Observation>> next() override {
        if (fails_after_ && next_ == *fails_after_)
            return Error{Errc::kMalformed, "the rest of the recording cannot be read"};
        if (next_ == observations_.size()) return std::optional<Observation>{};
        return std::optional(std::move(observations_[next_++]));
    }
    [[nodiscard]] std::optional<std::uint64_t> scan_count() const override {
        return is_endless_ ? std::nullopt : std::optional<std::uint64_t>(observations_.size());
    }

    void fail_after(std::size_t scans) { fails_after_ = scans; }
    void pretend_to_be_endless() { is_endless_ = true; }

private:
    std::vector<Observation> observations_;
    std::size_t next_ = 0;
    std::optional<std::size_t> fails_after_;
    bool is_endless_ = false;
};

} // namespace scanloom::robot
