#include "robot_client/ros/frame_tree.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

namespace scanloom::robot {

void FrameTree::add(const RosTransform& transform, bool is_static, std::uint32_t epoch) {
    if (kept_ && names_.size() >= kFramesMax && !(has(transform.child) && has(transform.header.frame))) return;
    Edge& edge = edges_[id_of(transform.child)];
    const Transform one{id_of(transform.header.frame), transform.T_parent_child.translation(),
                        Eigen::Quaterniond(transform.T_parent_child.linear())};
    if (!is_static) return insert(edge, {transform.header.stamp, epoch}, one);
    if (!edge.fixed) ++size_;
    edge.fixed = one;
}

bool FrameTree::are_equal(const Transform& a, const Transform& b) {
    return a.parent == b.parent && a.translation == b.translation && a.rotation.coeffs() == b.rotation.coeffs();
}

void FrameTree::insert(Edge& edge, EpochTime time, const Transform& one) {
    auto& moving = edge.moving;
    if (kept_ && !moving.empty() && std::prev(moving.end())->first.stamp - time.stamp > kSetBack) {
        size_ -= moving.size();
        moving.clear();
    }
    if (!moving.emplace(time, one).second) return;
    ++size_;
    forget(edge);
    const auto newest = std::prev(moving.end());
    if (newest->first != time || moving.size() < 3) return;
    const auto middle = std::prev(newest);
    if (std::prev(middle)->first.epoch != time.epoch) return;
    if (!are_equal(middle->second, one) || !are_equal(std::prev(middle)->second, one)) return;
    moving.erase(middle); // of equal ones in a row
    --size_;
}

/// Forgets transforms that are older than what is kept, but the last of them.
void FrameTree::forget(Edge& edge) {
    auto& moving = edge.moving;
    while (kept_ && moving.size() > 2 &&
           std::prev(moving.end())->first.stamp - std::next(moving.begin())->first.stamp > *kept_) {
        moving.erase(moving.begin());
        --size_;
    }
}

/// Returns the transform of a child at a time.
std::variant<FrameTree::Transform, NoTransform> FrameTree::at(const Edge& edge, EpochTime time) {
    if (edge.fixed) return *edge.fixed;
    if (edge.moving.empty()) return NoTransform::kNotConnected;
    auto found = at_in_epoch(edge, time);
    if (std::holds_alternative<Transform>(found) || has_near(edge, time)) return found;
    std::optional<NoTransform> reason; // of the nearest epoch
    for (const auto epoch : epochs_near(edge, time.epoch)) {
        auto other = at_in_epoch(edge, {time.stamp, epoch});
        if (std::holds_alternative<Transform>(other)) return other;
        if (!reason) reason = std::get<NoTransform>(other);
    }
    return reason.value_or(std::get<NoTransform>(found));
}

/// Returns whether a child has transforms of an epoch around a time.
bool FrameTree::has_near(const Edge& edge, EpochTime time) {
    using Limits = std::numeric_limits<RosTime>;
    const RosTime stamp = std::clamp(time.stamp, Limits::min() + kEpochMargin, Limits::max() - kEpochMargin);
    const auto near = edge.moving.lower_bound({stamp - kEpochMargin, time.epoch});
    return near != edge.moving.end() && near->first <= EpochTime(stamp + kEpochMargin, time.epoch);
}

/// Returns the epochs of a child's transforms but one, those nearest to it first, and not all of very many.
std::vector<std::uint32_t> FrameTree::epochs_near(const Edge& edge, std::uint32_t epoch) {
    constexpr std::size_t kEpochsMax = 64;
    constexpr RosTime kFirst = std::numeric_limits<RosTime>::min();
    std::vector<std::uint32_t> epochs;
    for (auto one = edge.moving.lower_bound({kFirst, epoch});
         one != edge.moving.begin() && epochs.size() < kEpochsMax / 2;
         one = edge.moving.lower_bound({kFirst, epochs.back()})) {
        epochs.push_back(std::prev(one)->first.epoch);
    }
    for (auto one = edge.moving.lower_bound({kFirst, epoch + 1});
         one != edge.moving.end() && epochs.size() < kEpochsMax;
         one = edge.moving.lower_bound({kFirst, epochs.back() + 1})) {
        epochs.push_back(one->first.epoch);
    }
    const auto distance = [&](std::uint32_t other) { return other > epoch ? other - epoch : epoch - other; };
    std::ranges::stable_sort(epochs, {}, distance);
    return epochs;
}

/// Returns the transform of a child at a time by the transforms of its epoch.
std::variant<FrameTree::Transform, NoTransform> FrameTree::at_in_epoch(const Edge& edge, EpochTime time) {
    const auto& moving = edge.moving;
    const auto after = moving.lower_bound(time);
    if (after == moving.end() || after->first.epoch != time.epoch) return NoTransform::kAfter;
    if (after->first == time) return after->second;
    if (after == moving.begin() || std::prev(after)->first.epoch != time.epoch) return NoTransform::kBefore;
    const auto before = std::prev(after);
    const RosTime span = after->first.stamp - before->first.stamp;
    const Transform& from = before->second;
    const Transform& to = after->second;
    if (are_equal(from, to)) return from;
    if (from.parent != to.parent || span > kHoleMax) return NoTransform::kHole;
    const double share = static_cast<double>(time.stamp - before->first.stamp) / static_cast<double>(span);
    return Transform{from.parent, from.translation + share * (to.translation - from.translation),
                     from.rotation.slerp(share, to.rotation)};
}

/// Lists a frame and those above it at a time, without frames that are above themselves: between these there are two
/// ways.
/// @return why the last one has no frame above it; nullopt: it has no parent at any time
std::optional<NoTransform> FrameTree::climb(Frame frame, EpochTime time, std::vector<Step>& steps) const {
    steps.push_back({frame, Eigen::Isometry3d::Identity()});
    for (;;) {
        const auto edge = edges_.find(steps.back().frame);
        if (edge == edges_.end()) return std::nullopt;
        const auto found = at(edge->second, time);
        if (const auto* reason = std::get_if<NoTransform>(&found)) return *reason;
        const auto& up = std::get<Transform>(found);
        const auto loop = std::ranges::find(steps, up.parent, &Step::frame);
        if (loop != steps.end()) {
            steps.erase(loop, steps.end());
            return NoTransform::kLoop;
        }
        const Eigen::Isometry3d T_parent_frame = Eigen::Translation3d(up.translation) * up.rotation;
        steps.push_back({up.parent, T_parent_frame * steps.back().T_frame_source});
    }
}

std::variant<Eigen::Isometry3d, NoTransform> FrameTree::find(std::string_view target, std::string_view source,
                                                             EpochTime time) const {
    if (target == source) return Eigen::Isometry3d::Identity();
    const auto target_id = ids_.find(std::string(target));
    const auto source_id = ids_.find(std::string(source));
    if (target_id == ids_.end() || source_id == ids_.end()) return NoTransform::kNotConnected;
    std::vector<Step> from_source;
    std::vector<Step> from_target;
    const auto source_end = climb(source_id->second, time, from_source);
    const auto target_end = climb(target_id->second, time, from_target);
    for (const Step& step : from_source) {
        const auto common = std::ranges::find(from_target, step.frame, &Step::frame);
        if (common == from_target.end()) continue;
        return common->T_frame_source.inverse() * step.T_frame_source;
    }
    if (target_end == NoTransform::kLoop) return NoTransform::kLoop;
    return source_end.value_or(NoTransform::kNotConnected);
}

std::vector<std::string> FrameTree::ancestors(std::string_view frame) const {
    std::vector<std::string> list{std::string(frame)};
    for (auto id = ids_.find(list.back()); id != ids_.end(); id = ids_.find(list.back())) {
        const auto edge = edges_.find(id->second);
        if (edge == edges_.end()) break;
        const auto& parent = names_[newest_parent(edge->second)];
        if (std::ranges::find(list, parent) != list.end()) break;
        list.push_back(parent);
    }
    return list;
}

std::set<std::string> FrameTree::children_of(bool (*is_parent)(std::string_view)) const {
    std::set<std::string> children;
    for (const auto& [child, edge] : edges_) {
        if (is_parent(names_[newest_parent(edge)])) children.insert(names_[child]);
    }
    return children;
}

bool FrameTree::is_static(std::string_view child) const {
    const Edge* edge = edge_of(child);
    return edge != nullptr && edge->fixed;
}

bool FrameTree::moves(std::string_view child) const {
    const Edge* edge = edge_of(child);
    if (edge == nullptr || edge->fixed) return false;
    const auto differ = [](const auto& a, const auto& b) { return !are_equal(a.second, b.second); };
    return std::ranges::adjacent_find(edge->moving, differ) != edge->moving.end();
}

const FrameTree::Edge* FrameTree::edge_of(std::string_view child) const {
    const auto id = ids_.find(std::string(child));
    const auto edge = id == ids_.end() ? edges_.end() : edges_.find(id->second);
    return edge == edges_.end() ? nullptr : &edge->second;
}

void FrameTree::join_epochs() {
    for (auto& [child, edge] : edges_) {
        if (edge.moving.empty() || edge.moving.rbegin()->first.epoch == 0) continue;
        std::map<EpochTime, Transform> joined;
        for (const auto& [time, one] : edge.moving) joined.emplace(time.stamp, one);
        edge.moving = std::move(joined);
    }
    count();
}

void FrameTree::keep_ancestors(const std::set<std::string>& frames) {
    std::set<std::string> kept;
    for (const auto& frame : frames) {
        for (auto& one : ancestors(frame)) kept.insert(std::move(one));
    }
    std::erase_if(edges_, [&](const auto& edge) { return !kept.contains(names_[edge.first]); });
    count();
}

void FrameTree::replace(const std::string& child, const FrameTree& other, const std::string& other_child) {
    Edge edge = other.edges_.at(other.ids_.at(other_child));
    if (edge.fixed) edge.fixed->parent = id_of(other.names_[edge.fixed->parent]);
    for (auto& [stamp, one] : edge.moving) one.parent = id_of(other.names_[one.parent]);
    edges_[id_of(child)] = std::move(edge);
    count();
}

void FrameTree::merge(const FrameTree& other) {
    for (const auto& [child, edge] : other.edges_) {
        const std::string& name = other.names_[child];
        if (!edges_.contains(id_of(name))) replace(name, other, name);
    }
}

void FrameTree::count() {
    size_ = 0;
    for (const auto& [frame, edge] : edges_) size_ += edge.moving.size() + (edge.fixed ? 1 : 0);
}

FrameTree::Frame FrameTree::id_of(const std::string& name) {
    const auto [id, is_new] = ids_.emplace(name, static_cast<Frame>(names_.size()));
    if (is_new) names_.push_back(name);
    return id->second;
}

} // namespace scanloom::robot
