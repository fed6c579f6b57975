#pragma once

#include "core/slam/pose_graph.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

/// A slow and simple version of the pose graph's contract, written directly from the header.
namespace scanloom::testing_support {

using slam::Edge;
using slam::Information;
using slam::Transform2;

struct Graph {
    std::vector<Transform2> poses;
    std::vector<Edge> edges;
};

/// Optimises with dense matrices and numeric derivatives, by the definition of the error.
class DenseOracle {
public:
    DenseOracle(const Graph& graph, double robust_scale) : edges_(graph.edges), robust_scale_(robust_scale) {
        for (const Transform2& pose : graph.poses) {
            coordinates_.insert(coordinates_.end(), {pose.x, pose.y, std::atan2(pose.rotation.sin, pose.rotation.cos)});
        }
    }

    /// Returns x, y and yaw of each node after the steps. The first node is fixed.
    const std::vector<double>& optimize(int steps) {
        const auto rows = static_cast<Eigen::Index>(3 * edges_.size());
        const auto columns = static_cast<Eigen::Index>(coordinates_.size() - 3);
        for (int step = 0; step < steps; ++step) {
            const Eigen::VectorXd error = normalized_errors();
            Eigen::MatrixXd jacobian(rows, columns);
            for (Eigen::Index column = 0; column < columns; ++column) {
                double& coordinate = coordinates_[static_cast<std::size_t>(column + 3)];
                const double kept = coordinate;
                constexpr double kShift = 1e-5;
                coordinate = kept + kShift;
                const Eigen::VectorXd above = normalized_errors();
                coordinate = kept - kShift;
                jacobian.col(column) = (above - normalized_errors()) / (2.0 * kShift);
                coordinate = kept;
            }
            const Eigen::VectorXd weights = weights_of(error);
            const Eigen::MatrixXd weighted = weights.asDiagonal() * jacobian;
            const Eigen::VectorXd move = (weighted.transpose() * weighted)
                                             .ldlt()
                                             .solve(-weighted.transpose() * (weights.array() * error.array()).matrix());
            for (Eigen::Index column = 0; column < columns; ++column) {
                coordinates_[static_cast<std::size_t>(column + 3)] += move(column);
            }
        }
        return coordinates_;
    }

private:
    /// Returns three errors an edge, multiplied by a root of the information.
    [[nodiscard]] Eigen::VectorXd normalized_errors() const {
        Eigen::VectorXd errors(3 * static_cast<Eigen::Index>(edges_.size()));
        Eigen::Index row = 0;
        for (const Edge& edge : edges_) {
            const double* from = coordinates_.data() + 3 * edge.from;
            const double* to = coordinates_.data() + 3 * edge.to;
            const Eigen::Vector2d moved =
                Eigen::Rotation2Dd(-from[2]) * Eigen::Vector2d(to[0] - from[0], to[1] - from[1]);
            const double yaw = to[2] - from[2] - scan_matching::yaw_of(edge.T_from_to);
            const Eigen::Vector3d error(moved.x() - edge.T_from_to.x, moved.y() - edge.T_from_to.y,
                                        std::remainder(yaw, 2.0 * std::numbers::pi));
            const Information& i = edge.information;
            Eigen::Matrix3d full;
            full << i.xx, i.xy, i.xyaw, i.xy, i.yy, i.yyaw, i.xyaw, i.yyaw, i.yawyaw;
            errors.segment<3>(row) = full.llt().matrixU() * error;
            row += 3;
        }
        return errors;
    }

    /// Returns the weight of each error.
    [[nodiscard]] Eigen::VectorXd weights_of(const Eigen::VectorXd& errors) const {
        Eigen::VectorXd weights = Eigen::VectorXd::Ones(errors.size());
        for (std::size_t edge = 0; edge < edges_.size(); ++edge) {
            if (!edges_[edge].is_robust) continue;
            const auto row = static_cast<Eigen::Index>(3 * edge);
            const double squared = errors.segment<3>(row).squaredNorm();
            weights.segment<3>(row).setConstant(std::min(1.0, 2.0 * robust_scale_ / (robust_scale_ + squared)));
        }
        return weights;
    }

    std::vector<Edge> edges_;
    double robust_scale_;
    std::vector<double> coordinates_;
};

} // namespace scanloom::testing_support
