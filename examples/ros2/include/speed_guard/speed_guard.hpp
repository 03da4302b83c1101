// SPDX-License-Identifier: BSD-3-Clause
// Speed factors of the Panda by the names of its joints; no part of ROS 2.
#pragma once

#include <string>
#include <vector>

#include "panda.hpp"

namespace speed_guard {

struct Guard {
    panda::params drives;
    panda_region body{};

    // Against a chest that can give way, for springs that are all alike [N m/rad].
    explicit Guard(double joint_stiffness);

    // Factor of all joint velocities; 0 where nothing is known to be safe, or a joint is missing.
    double factor(const std::vector<std::string> &names, const std::vector<double> &positions,
        const std::vector<double> &velocities) const;
};

} // namespace speed_guard
