// SPDX-License-Identifier: BSD-3-Clause
// The library alone: at rest, slow, fast, and with a joint missing.
#include <cstdio>

#include "speed_guard/speed_guard.hpp"

int main()
{
    const speed_guard::Guard guard(3000);
    std::vector<std::string> names;
    for (int i = PANDA_JOINTS; i > 0; --i) { // in an order of their own
        names.push_back("panda_joint" + std::to_string(i));
    }
    const std::vector<double> q = {0.5, 2, 0.3, -2, 0.2, -0.3, 0.1};
    std::vector<double> dq(names.size(), 0);
    const double rest = guard.factor(names, q, dq);
    dq.back() = 0.1;
    const double slow = guard.factor(names, q, dq);
    dq.back() = 2.5;
    const double fast = guard.factor(names, q, dq);
    names.pop_back();
    const double missing = guard.factor(names, q, dq);
    std::printf("%g %g %g %g\n", rest, slow, fast, missing);
    return rest >= 1 && slow >= 1 && fast > 0 && fast < 1 && missing <= 0 ? 0 : 1;
}
