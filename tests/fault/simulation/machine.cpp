#include "tests/fault/simulation/machine.hpp"

#include <boost/asio/execution.hpp>

#include <utility>

namespace scanloom::simulation {

namespace asio = boost::asio;

namespace {

constexpr Duration kTaskLatest = std::chrono::microseconds(300);

/// Implements Asio's executor requirements.
class Executor {
public:
    explicit Executor(Machine& machine) : machine_(&machine) {}

    [[nodiscard]] asio::execution_context& query(asio::execution::context_t) const noexcept { return *machine_; }
    [[nodiscard]] static constexpr asio::execution::blocking_t query(asio::execution::blocking_t) noexcept {
        return asio::execution::blocking.never;
    }
    [[nodiscard]] Executor require(asio::execution::blocking_t::never_t) const noexcept { return *this; }

    template <class Task>
    void execute(Task&& task) const {
        auto shared = std::make_shared<std::decay_t<Task>>(std::forward<Task>(task)); // it may be movable only
        machine_->add([shared] { std::move (*shared)(); });
    }

    friend bool operator==(const Executor&, const Executor&) = default;

private:
    Machine* machine_;
};

} // namespace

asio::any_io_executor Machine::executor() { return Executor(*this); }

void Machine::add(std::function<void()> task) {
    if (killed_) return;
    if (hastened_) return task();
    tasks_.emplace(++last_, std::move(task));
    world_.after(world_.between(Duration(0), kTaskLatest), [self = std::weak_ptr(self_), id = last_] {
        if (const auto alive = self.lock()) (*alive)->run(id);
    });
}

void Machine::run(std::uint64_t number) {
    auto task = tasks_.extract(number);
    if (task) task.mapped()();
}

void Machine::hasten() {
    hastened_ = true;
    while (!tasks_.empty()) run(tasks_.begin()->first);
}

void Machine::kill() {
    killed_ = true;
    while (!tasks_.empty()) tasks_.erase(tasks_.begin()); // one may own what owns others
    shutdown();
}

} // namespace scanloom::simulation
