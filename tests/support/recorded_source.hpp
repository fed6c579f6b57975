#pragma once

#include "robot_client/source/source.hpp"

#include <vector>

namespace scanloom::robot {

/// A recording as a source: scan i of it has seq i + 1, so a later run continues where the server stands.
class RecordedSource final : public Source {
public:
    explicit RecordedSource(std::vector<Observation> observations) : observations_(std::move(observations)) {}

    [[nodiscard]] std::optional<Observation> next() override;
    [[nodiscard]] Result<> resume_after(std::uint64_t seq) override;
    [[nodiscard]] std::optional<std::uint64_t> scan_count() const override { return observations_.size(); }

private:
    std::vector<Observation> observations_;
    std::size_t next_ = 0;
};

} // namespace scanloom::robot
