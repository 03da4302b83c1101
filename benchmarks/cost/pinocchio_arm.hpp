// SPDX-License-Identifier: BSD-3-Clause
// The same quantities by Pinocchio and Eigen, as one would write them: crba and its Jacobian, fixed
// sizes, Cholesky factors, and the structure of M0 and K0 instead of a general 14x14 inverse.
#pragma once

#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/multibody.hpp>

#include <istream>
#include <string>

#include "sample.h"

class PinocchioArm {
 public:
  static constexpr int N = PANDA_JOINTS;
  using Vector = Eigen::Matrix<double, N, 1>;
  using Matrix = Eigen::Matrix<double, N, N>;

  // Reads for each joint: placement (rotation by rows, translation), mass, centre of mass, inertia
  // about it by rows; then the tip in the last joint's frame.
  explicit PinocchioArm(std::istream& in) : model_(read(in)), data_(model_) {
    for (int i = 0; i < 3; ++i) in >> tip_[i];
  }

  void massMatrix(const sample& s, double* out) {
    crba(s, pinocchio::Convention::LOCAL);
    Eigen::Map<Matrix> M(out);
    M = data_.M.selfadjointView<Eigen::Upper>();
  }

  void osim(const sample& s, double* out) {
    mobilities(s);
    Eigen::Map<Eigen::Matrix3d>{out} = real_.inverse();
    Eigen::Map<Eigen::Matrix3d>{out + 9} = free_.inverse();
  }

  void giaf(const sample& s, double* out) {
    mobilities(s);
    const double det = free_.determinant();
    out[0] = real_.determinant() / det;
    out[1] = (free_ - real_).determinant() / det;
  }

  void reflectedMass(const sample& s, double* out) {
    const Vector j = towards(s);
    const Eigen::LLT<Matrix, Eigen::Upper> factors(data_.M);
    out[0] = 1 / factors.matrixL().solve(j).squaredNorm();
  }

  void reducedModel(const sample& s, double* out) {
    using Vector2 = Eigen::Matrix<double, 2 * N, 1>;
    using Matrix2 = Eigen::Matrix<double, 2 * N, 2 * N>;
    const Vector j = towards(s);
    const Eigen::LLT<Matrix, Eigen::Upper> factors(data_.M);
    const Vector pushed = factors.solve(j);  // M0^-1 J_c' is (0, M^-1 j)
    const double m_c = 1 / j.dot(pushed);
    const Eigen::Map<const Vector> springs(s.p.joint_stiffness), gains(s.p.position_gain);
    const Eigen::Map<const Vector> rotors(s.p.rotor_inertia);
    const Vector bent = m_c * springs.cwiseProduct(pushed);
    const double k_r = m_c * bent.dot(pushed);

    Vector2 J, w;
    J << j, j;
    w << Vector::Zero(), bent;
    Matrix2 difference = -m_c * J * J.transpose();  // N = M0 - m_c J_c'J_c
    const Matrix M = data_.M.selfadjointView<Eigen::Upper>();
    for (int row : {0, N})
      for (int column : {0, N}) difference.block<N, N>(row, column) += M;
    difference.diagonal().head<N>() += rotors;
    Matrix2 B = k_r * J * J.transpose() - w * J.transpose() - J * w.transpose();
    B.diagonal().head<N>() += gains;
    B.diagonal().tail<N>() += springs;
    out[0] = m_c;
    out[1] = k_r;
    out[2] = k_r * difference.cwiseProduct(B).sum() / B.squaredNorm();
  }

 private:
  using Jacobian = Eigen::Matrix<double, 3, N>;

  void crba(const sample& s, pinocchio::Convention convention) {
    pinocchio::crba(model_, data_, Eigen::Map<const Vector>(s.q), convention);
  }

  // crba in the world's frame leaves the joints' Jacobian behind.
  Jacobian jacobian(const sample& s) {
    crba(s, pinocchio::Convention::WORLD);
    const Eigen::Vector3d p = data_.oMi[N].act(tip_);
    Jacobian J = data_.J.topRows<3>();
    for (int i = 0; i < N; ++i) J.col(i) += data_.J.col(i).tail<3>().cross(p);
    return J;
  }

  Vector towards(const sample& s) {
    return jacobian(s).transpose() * Eigen::Map<const Eigen::Vector3d>(s.n);
  }

  // J M^-1 J' with and without rotors.
  void mobilities(const sample& s) {
    const Jacobian J = jacobian(s);
    const Eigen::LLT<Matrix, Eigen::Upper> links(data_.M);
    Matrix M = data_.M;
    M.diagonal() += Eigen::Map<const Vector>(s.p.rotor_inertia);
    const Eigen::LLT<Matrix, Eigen::Upper> all(M);
    const Eigen::Matrix<double, N, 3> a = links.matrixL().solve(J.transpose());
    const Eigen::Matrix<double, N, 3> b = all.matrixL().solve(J.transpose());
    free_ = a.transpose() * a;
    real_ = b.transpose() * b;
  }

  template <int rows, int columns>
  static Eigen::Matrix<double, rows, columns> numbers(std::istream& in) {
    Eigen::Matrix<double, rows, columns> m;
    for (int i = 0; i < rows; ++i)
      for (int j = 0; j < columns; ++j) in >> m(i, j);
    return m;
  }

  static pinocchio::Model read(std::istream& in) {
    pinocchio::Model model;
    pinocchio::JointIndex last = 0;
    for (int i = 0; i < N; ++i) {
      const Eigen::Matrix3d rotation = numbers<3, 3>(in);
      const Eigen::Vector3d translation = numbers<3, 1>(in);
      const double mass = numbers<1, 1>(in)(0);
      const Eigen::Vector3d com = numbers<3, 1>(in);
      const Eigen::Matrix3d about_com = numbers<3, 3>(in);
      last = model.addJoint(last, pinocchio::JointModelRZ(), {rotation, translation},
                            "joint" + std::to_string(i));
      model.appendBodyToJoint(last, {mass, com, about_com});
    }
    return model;
  }

  pinocchio::Model model_;
  pinocchio::Data data_;
  Eigen::Vector3d tip_;
  Eigen::Matrix3d free_, real_;
};
