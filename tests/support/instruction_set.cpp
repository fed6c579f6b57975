#include "tests/support/instruction_set.hpp"

#include <hwy/highway.h>

#include <cassert>
#include <cstdint>

namespace scanloom::mapping::simd {
namespace {

/// From the fastest set, which has the lowest bit.
std::vector<std::int64_t> targets() {
    std::vector<std::int64_t> found;
    for (std::int64_t rest = hwy::SupportedTargets() & HWY_TARGETS; rest != 0; rest &= rest - 1) {
        found.push_back(rest & -rest);
    }
    return found;
}

} // namespace

std::vector<std::string_view> instruction_sets() {
    std::vector<std::string_view> names;
    for (const std::int64_t target : targets()) names.emplace_back(hwy::TargetName(target));
    return names;
}

std::string_view instruction_set() { return instruction_sets().front(); }

void use_instruction_set(std::string_view name) {
    hwy::SetSupportedTargetsForTest(0);
    if (!name.empty()) {
        for (const std::int64_t target : targets()) {
            if (name == hwy::TargetName(target)) hwy::SetSupportedTargetsForTest(target);
        }
    }
    assert(name.empty() || instruction_set() == name);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

} // namespace scanloom::mapping::simd
