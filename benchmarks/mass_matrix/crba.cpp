// SPDX-License-Identifier: BSD-3-Clause
// Times a generated mass matrix against Pinocchio's crba on the same robot and configurations.
//
// Reads from standard input: joints, and for each its placement (rotation by rows, translation),
// mass, centre of mass and inertia about it by rows; then configurations, each with one angle a
// joint. Writes the largest relative difference of the two, and nanoseconds a call.

#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/multibody.hpp>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <iostream>
#include <vector>

#include "panda.h"

using Clock = std::chrono::steady_clock;
constexpr int joints = PANDA_JOINTS;
constexpr int rounds = 200;
constexpr int passes = 20;

template <int rows, int columns>
static Eigen::Matrix<double, rows, columns> read() {
  Eigen::Matrix<double, rows, columns> m;
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) std::cin >> m(i, j);
  return m;
}

static pinocchio::Model readModel() {
  pinocchio::Model model;
  pinocchio::JointIndex last = 0;
  int count = 0;
  std::cin >> count;
  for (int i = 0; i < count; ++i) {
    const Eigen::Matrix3d rotation = read<3, 3>();
    const Eigen::Vector3d translation = read<3, 1>();
    const double mass = read<1, 1>()(0);
    const Eigen::Vector3d com = read<3, 1>();
    const Eigen::Matrix3d about_com = read<3, 3>();
    last = model.addJoint(last, pinocchio::JointModelRZ(), {rotation, translation},
                          "joint" + std::to_string(i));
    model.appendBodyToJoint(last, {mass, com, about_com});
  }
  return model;
}

// Nanoseconds a call over all configurations, in the fastest of several passes.
template <typename Call>
static double time(const std::vector<Eigen::VectorXd>& configurations, Call call) {
  const auto start = Clock::now();
  for (int round = 0; round < rounds; ++round)
    for (const auto& q : configurations) call(q);
  const std::chrono::duration<double, std::nano> taken = Clock::now() - start;
  return taken.count() / (rounds * static_cast<double>(configurations.size()));
}

int main() {
  const pinocchio::Model model = readModel();
  pinocchio::Data data(model);
  int count = 0;
  std::cin >> count;
  std::vector<Eigen::VectorXd> configurations;
  for (int i = 0; i < count; ++i) configurations.push_back(read<joints, 1>());
  if (!std::cin || model.nv != joints) return 1;

  Eigen::Matrix<double, joints, joints, Eigen::RowMajor> M;
  double (*const rows)[joints] = reinterpret_cast<double (*)[joints]>(M.data());
  volatile double sink = 0;  // keeps the results alive
  const auto ours = [&](const Eigen::VectorXd& q) {
    panda_mass_matrix(q.data(), rows);
    sink = M(0, 0);
  };
  const auto local = [&](const Eigen::VectorXd& q) {
    sink = pinocchio::crba(model, data, q, pinocchio::Convention::LOCAL)(0, 0);
  };
  const auto world = [&](const Eigen::VectorXd& q) {
    sink = pinocchio::crba(model, data, q, pinocchio::Convention::WORLD)(0, 0);
  };

  double difference = 0;
  for (const auto& q : configurations) {
    ours(q);
    local(q);
    const Eigen::MatrixXd right = data.M.selfadjointView<Eigen::Upper>();
    difference = std::max(difference, (M - right).cwiseAbs().maxCoeff() / right.cwiseAbs().maxCoeff());
  }
  double best[3] = {1e30, 1e30, 1e30};
  for (int pass = 0; pass < passes; ++pass) {
    best[0] = std::min(best[0], time(configurations, ours));
    best[1] = std::min(best[1], time(configurations, local));
    best[2] = std::min(best[2], time(configurations, world));
  }
  std::printf("%.17g %.17g %.17g %.17g\n", difference, best[0], best[1], best[2]);
  return 0;
}
