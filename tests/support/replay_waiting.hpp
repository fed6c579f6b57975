#pragma once

#include "server/sessions/replay_job.hpp"

#include <chrono>
#include <future>
#include <memory>

namespace scanloom::testing_support {

/// Waits up to `timeout` for maps that contain the entry `revision`, or for the end of the job.
/// @return null if there are no such maps
inline std::shared_ptr<const mapping::Snapshot> wait_for_maps(sessions::ReplayJob& job, Revision revision,
                                                              std::chrono::milliseconds timeout) {
    const auto ready = std::make_shared<std::promise<void>>(); // may be used after the timeout has passed
    job.notify(revision, [ready] { ready->set_value(); });
    static_cast<void>(ready->get_future().wait_for(timeout));
    return job.maps_with(revision);
}

} // namespace scanloom::testing_support
