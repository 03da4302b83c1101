// SPDX-License-Identifier: BSD-3-Clause
#include "speed_guard/speed_guard.hpp"

#include <algorithm>

namespace speed_guard {

namespace {

const char *const joints[PANDA_JOINTS] = {"panda_joint1", "panda_joint2", "panda_joint3",
    "panda_joint4", "panda_joint5", "panda_joint6", "panda_joint7"};

} // namespace

Guard::Guard(double joint_stiffness)
{
    std::fill(std::begin(drives.joint_stiffness), std::end(drives.joint_stiffness),
        static_cast<panda::real>(joint_stiffness));
    drives.horizon = panda::real(0.1); // s; what comes later is for the quasi-static limit
    body = panda::body_region(PANDA_CHEST, false).value;
}

double Guard::factor(const std::vector<std::string> &names, const std::vector<double> &positions,
    const std::vector<double> &velocities) const
{
    panda::vector<PANDA_JOINTS> q{};
    panda::vector<PANDA_JOINTS> dq{};
    for (std::size_t i = 0; i < PANDA_JOINTS; ++i) {
        const auto at = static_cast<std::size_t>(
            std::find(names.begin(), names.end(), joints[i]) - names.begin());
        if (at == names.size() || at >= positions.size() || at >= velocities.size()) {
            return 0;
        }
        q[i] = static_cast<panda::real>(positions[at]);
        dq[i] = static_cast<panda::real>(velocities[at]);
    }
    const auto found = panda::speed_factor(q, dq, body.force_limit, body, drives);
    return found ? static_cast<double>(found.value.factor) : 0;
}

} // namespace speed_guard
