#pragma once

#include "tests/fault/simulation/world.hpp"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/execution_context.hpp>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>

namespace scanloom::simulation {

/// The threads of one program, one for each task: each task runs a moment after it was posted, in any order. A strand
/// on it keeps its own order, as on real threads.
class Machine : public boost::asio::execution_context {
public:
    explicit Machine(World& world) : world_(world) {}
    ~Machine() { shutdown(); }

    [[nodiscard]] boost::asio::any_io_executor executor();

    void add(std::function<void()> task);

    /// Runs all waiting tasks, and later tasks immediately. For calls that wait for other threads.
    void hasten();
    void go_on_normally() noexcept { hastened_ = false; }

    /// Kills the program: waiting tasks never run, here or on strands.
    void kill();

private:
    void run(std::uint64_t number);

    World& world_;
    std::map<std::uint64_t, std::function<void()>> tasks_;
    std::uint64_t last_ = 0;
    bool hastened_ = false;
    bool killed_ = false;
    std::shared_ptr<Machine*> self_ = std::make_shared<Machine*>(this); // for events that may run after the destructor
};

} // namespace scanloom::simulation
