#include "core/slam/pose_graph.hpp"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCholesky>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

namespace scanloom::slam {
namespace {

using scan_matching::SinCos;

// Small matrices are multiplied here and not by Eigen: it sums in an order that depends on the processor.
using Vector3 = std::array<double, 3>;
using Matrix3 = std::array<Vector3, 3>; // by rows

Matrix3 product(const Matrix3& a, const Matrix3& b) {
    Matrix3 result;
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) result[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
    }
    return result;
}

Matrix3 transposed(const Matrix3& a) {
    return {{{a[0][0], a[1][0], a[2][0]}, {a[0][1], a[1][1], a[2][1]}, {a[0][2], a[1][2], a[2][2]}}};
}

Vector3 product(const Matrix3& a, const Vector3& b) {
    Vector3 result;
    for (std::size_t i = 0; i < 3; ++i) result[i] = a[i][0] * b[0] + a[i][1] * b[1] + a[i][2] * b[2];
    return result;
}

Matrix3 matrix_of(const Information& information) {
    const auto& [xx, xy, xyaw, yy, yyaw, yawyaw] = information;
    return {{{xx, xy, xyaw}, {xy, yy, yyaw}, {xyaw, yyaw, yawyaw}}};
}

SinCos inverse(const SinCos& rotation) { return {-rotation.sin, rotation.cos}; }

/// Returns the relative pose of the edge's nodes minus the measured one: x, y (metres), yaw (radians).
Vector3 error_of(const Edge& edge, std::span<const Transform2> poses) {
    const Transform2& from = poses[edge.from];
    const Transform2& to = poses[edge.to];
    const auto [s, c] = from.rotation;
    const double dx = to.x - from.x;
    const double dy = to.y - from.y;
    const SinCos turn = inverse(edge.T_from_to.rotation) * (inverse(from.rotation) * to.rotation);
    return {c * dx + s * dy - edge.T_from_to.x, c * dy - s * dx - edge.T_from_to.y,
            scan_matching::angle_of(turn.sin, turn.cos)};
}

/// Returns the weight of an edge, the factor of its normalised error.
double weight_of(const Edge& edge, const Vector3& error, double robust_scale) {
    if (!edge.is_robust) return 1.0;
    const Vector3 weighted = product(matrix_of(edge.information), error);
    const double squared = error[0] * weighted[0] + error[1] * weighted[1] + error[2] * weighted[2];
    return std::min(1.0, 2.0 * robust_scale / (robust_scale + squared));
}

/// Returns for each node whether it is fixed, or the first node of a component without a fixed node.
std::vector<bool> held_nodes(std::size_t count, std::span<const std::size_t> fixed, std::span<const Edge> edges) {
    std::vector<bool> held(count, false);
    for (const std::size_t node : fixed) held[node] = true;
    std::vector<std::size_t> parents(count);
    std::iota(parents.begin(), parents.end(), std::size_t{0});
    const auto root_of = [&](std::size_t node) {
        while (parents[node] != node) node = parents[node] = parents[parents[node]];
        return node;
    };
    for (const Edge& edge : edges) {
        auto [low, high] = std::minmax({root_of(edge.from), root_of(edge.to)});
        if (held[high] && !held[low]) std::swap(low, high);
        parents[high] = low;
    }
    for (std::size_t node = 0; node < count; ++node) held[node] = held[node] || parents[node] == node;
    return held;
}

/// The linear system of a Gauss-Newton step. It depends on the poses; its sparsity pattern depends on the edges alone,
/// and is computed once.
class NormalEquations {
public:
    NormalEquations(std::size_t node_count, std::span<const std::size_t> fixed, std::span<const Edge> edges) {
        const auto held = held_nodes(node_count, fixed, edges);
        number_nodes(held, edges);
        make_pattern(edges);
        if (!nodes_.empty()) solver_.analyzePattern(matrix_);
    }

    void clear() {
        std::fill_n(matrix_.valuePtr(), matrix_.nonZeros(), 0.0);
        std::ranges::fill(descent_, 0.0);
    }

    /// Adds an edge at its current error.
    /// @param index   of the edge, as given to the constructor
    /// @param factor  of its information
    void add(std::size_t index, const Edge& edge, std::span<const Transform2> poses, const Vector3& error,
             double factor) {
        const std::size_t from = places_[edge.from];
        const std::size_t to = places_[edge.to];
        const auto [s, c] = poses[edge.from].rotation;
        const double x = error[0] + edge.T_from_to.x; // of `to` in the frame of `from`
        const double y = error[1] + edge.T_from_to.y;
        const Matrix3 by_from = {{{-c, -s, y}, {s, -c, -x}, {0.0, 0.0, -1.0}}}; // derivative of the error
        const Matrix3 by_to = {{{c, s, 0.0}, {-s, c, 0.0}, {0.0, 0.0, 1.0}}};
        Matrix3 information = matrix_of(edge.information);
        for (Vector3& row : information) {
            for (double& element : row) element *= factor;
        }
        const Matrix3 from_weighted = product(transposed(by_from), information);
        const Matrix3 to_weighted = product(transposed(by_to), information);
        if (from != kHeld) add_node(from, product(from_weighted, by_from), product(from_weighted, error));
        if (to != kHeld) add_node(to, product(to_weighted, by_to), product(to_weighted, error));
        if (from == kHeld || to == kHeld) return;
        const Matrix3 block = from < to ? product(from_weighted, by_to) : product(to_weighted, by_from);
        for (std::size_t column = 0; column < 3; ++column) {
            double* values = values_of(std::max(from, to), column) + 3 * ranks_[index];
            for (std::size_t row = 0; row < 3; ++row) values[row] += block[row][column];
        }
    }

    /// Moves the nodes by the step that the edges added demand.
    /// @return the largest change of a coordinate, metres or radians; nullopt if the step is not determined
    std::optional<double> step(std::span<Transform2> poses) {
        if (nodes_.empty()) return 0.0;
        solver_.factorize(matrix_);
        if (solver_.info() != Eigen::Success) return std::nullopt;
        const Eigen::VectorXd moves = solver_.solve(descent_);
        double largest = 0.0;
        for (const double move : moves) largest = std::isfinite(move) ? std::max(largest, std::fabs(move)) : kInfinite;
        if (largest == kInfinite) return std::nullopt;
        const double* move = moves.data();
        for (const std::size_t node : nodes_) {
            poses[node].x += *move++;
            poses[node].y += *move++;
            poses[node].rotation = poses[node].rotation * scan_matching::sin_cos(*move++);
        }
        return largest;
    }

private:
    using Matrix = Eigen::SparseMatrix<double>;
    static constexpr std::size_t kHeld = std::numeric_limits<std::size_t>::max();
    static constexpr double kInfinite = std::numeric_limits<double>::infinity();

    /// Numbers the nodes that move in an order that keeps the factor of the matrix sparse. Ordering nodes instead of
    /// their coordinates takes a ninth of the elements.
    void number_nodes(const std::vector<bool>& held, std::span<const Edge> edges) {
        places_.assign(held.size(), kHeld);
        std::vector<Eigen::Triplet<double>> links;
        const auto link = [&](std::size_t from, std::size_t to) {
            links.emplace_back(static_cast<int>(places_[from]), static_cast<int>(places_[to]), 1.0);
        };
        for (std::size_t node = 0; node < held.size(); ++node) {
            if (held[node]) continue;
            places_[node] = nodes_.size();
            nodes_.push_back(node);
            link(node, node); // AMDOrdering puts rows without a diagonal element last
        }
        if (nodes_.empty()) return;
        for (const Edge& edge : edges) {
            if (!held[edge.from] && !held[edge.to]) link(edge.from, edge.to);
        }
        const auto size = static_cast<Eigen::Index>(nodes_.size());
        Matrix graph(size, size);
        graph.setFromTriplets(links.begin(), links.end());
        Eigen::AMDOrdering<int>::PermutationType order;
        Eigen::AMDOrdering<int>{}(graph, order);
        const auto unordered = nodes_;
        for (std::size_t place = 0; place < nodes_.size(); ++place) {
            nodes_[place] = unordered[static_cast<std::size_t>(order.indices()[static_cast<Eigen::Index>(place)])];
            places_[nodes_[place]] = place;
        }
    }

    /// Makes the upper triangle of the matrix: in the columns of each node, the blocks of its neighbours that precede
    /// it, then the upper triangle of its own.
    void make_pattern(std::span<const Edge> edges) {
        std::vector<std::vector<std::size_t>> neighbours(nodes_.size());
        const auto each_link = [&](auto&& visit) {
            for (std::size_t index = 0; index < edges.size(); ++index) {
                const auto [low, high] = std::minmax({places_[edges[index].from], places_[edges[index].to]});
                assert(edges[index].from != edges[index].to);
                if (high != kHeld) visit(index, low, neighbours[high]);
            }
        };
        each_link([](std::size_t, std::size_t low, auto& before) { before.push_back(low); });
        std::size_t blocks = nodes_.size();
        for (auto& before : neighbours) {
            std::ranges::sort(before);
            before.erase(std::unique(before.begin(), before.end()), before.end());
            blocks += before.size();
        }
        ranks_.assign(edges.size(), 0);
        each_link([&](std::size_t index, std::size_t low, const auto& before) {
            ranks_[index] = static_cast<std::size_t>(std::ranges::lower_bound(before, low) - before.begin());
        });

        const auto size = static_cast<Eigen::Index>(3 * nodes_.size());
        matrix_.resize(size, size);
        matrix_.resizeNonZeros(static_cast<Eigen::Index>(9 * blocks - 3 * nodes_.size()));
        descent_.resize(size);
        int* rows = matrix_.innerIndexPtr();
        int* starts = matrix_.outerIndexPtr();
        for (std::size_t place = 0; place < nodes_.size(); ++place) {
            for (std::size_t column = 0; column < 3; ++column) {
                *starts++ = static_cast<int>(rows - matrix_.innerIndexPtr());
                for (const std::size_t low : neighbours[place]) {
                    for (std::size_t row = 0; row < 3; ++row) *rows++ = static_cast<int>(3 * low + row);
                }
                for (std::size_t row = 0; row <= column; ++row) *rows++ = static_cast<int>(3 * place + row);
            }
        }
        *starts = static_cast<int>(rows - matrix_.innerIndexPtr());
    }

    /// Returns the values of one of the three columns of a node.
    double* values_of(std::size_t place, std::size_t column) {
        return matrix_.valuePtr() + matrix_.outerIndexPtr()[3 * place + column];
    }

    void add_node(std::size_t place, const Matrix3& block, const Vector3& gradient) {
        for (std::size_t column = 0; column < 3; ++column) {
            double* end = values_of(place, column + 1); // the block is at the end of its columns
            for (std::size_t row = 0; row <= column; ++row) (end - column - 1)[row] += block[row][column];
            descent_[static_cast<Eigen::Index>(3 * place + column)] -= gradient[column];
        }
    }

    std::vector<std::size_t> nodes_;  // that move, in the order of the matrix
    std::vector<std::size_t> places_; // of each node in nodes_, or kHeld
    std::vector<std::size_t> ranks_;  // of each edge's block in its columns
    Matrix matrix_;                   // upper triangle
    Eigen::VectorXd descent_;         // negative gradient
    Eigen::SimplicialLDLT<Matrix, Eigen::Upper, Eigen::NaturalOrdering<int>> solver_;
};

bool solve(NormalEquations& equations, std::span<Transform2> poses, std::span<Edge> edges,
           const OptimizeOptions& options) {
    bool converged = false;
    for (int iteration = 0; iteration < options.max_iterations && !converged; ++iteration) {
        equations.clear();
        for (std::size_t index = 0; index < edges.size(); ++index) {
            const Vector3 error = error_of(edges[index], poses);
            const double weight = weight_of(edges[index], error, options.robust_scale);
            equations.add(index, edges[index], poses, error, weight * weight);
        }
        const auto largest = equations.step(poses);
        if (!largest) break;
        converged = *largest < options.step_limit;
    }
    for (Edge& edge : edges) edge.weight = weight_of(edge, error_of(edge, poses), options.robust_scale);
    return converged;
}

} // namespace

Information information_of(double position_sigma, double yaw_sigma) noexcept {
    const double position = 1.0 / (position_sigma * position_sigma);
    return {.xx = position, .yy = position, .yawyaw = 1.0 / (yaw_sigma * yaw_sigma)};
}

bool optimize(std::span<Transform2> poses, std::span<const std::size_t> fixed, std::span<Edge> edges,
              const OptimizeOptions& options) {
    NormalEquations equations(poses.size(), fixed, edges);
    return solve(equations, poses, edges, options);
}

bool optimize_gradually(std::span<Transform2> poses, std::span<const std::size_t> fixed, std::span<Edge> edges,
                        const OptimizeOptions& options) {
    NormalEquations equations(poses.size(), fixed, edges);
    OptimizeOptions pass = options;
    for (const double scale : {1e6, 1e3, 100.0, 30.0}) {
        pass.robust_scale = scale;
        solve(equations, poses, edges, pass);
    }
    return solve(equations, poses, edges, options);
}

} // namespace scanloom::slam
