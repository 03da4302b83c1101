// SPDX-License-Identifier: BSD-3-Clause
// By how much to slow down each state of a motion so that a collision with a chest keeps its limit.
// Lines of q1 ... q7, dq1 ... dq7 (rad, rad/s) in, factors out; 0 where nothing is known to be safe.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <string>

#include "panda.hpp"

namespace {

panda::params drives()
{
    panda::params p;
    for (auto &k : p.joint_stiffness) {
        k = 3000; // N m/rad; yours
    }
    p.horizon = panda::real(0.1); // s; what comes later is for the quasi-static limit
    return p;
}

bool read(const std::string &line, panda::vector<PANDA_JOINTS> &q, panda::vector<PANDA_JOINTS> &dq)
{
    const char *at = line.c_str();
    for (auto *values : {&q, &dq}) {
        for (auto &x : *values) {
            char *end = nullptr;
            x = static_cast<panda::real>(std::strtod(at, &end));
            if (end == at) {
                return false;
            }
            at = *end == ',' ? end + 1 : end;
        }
    }
    return *at == '\0';
}

} // namespace

int main()
{
    if (std::strcmp(panda_model_digest(), PANDA_MODEL_DIGEST) != 0) {
        return std::fputs("the library is of another robot\n", stderr), 3;
    }
    const auto p = drives();
    const auto chest = panda::body_region(PANDA_CHEST, false);
    panda::vector<PANDA_JOINTS> q{};
    panda::vector<PANDA_JOINTS> dq{};
    int number = 0;
    for (std::string line; std::getline(std::cin, line);) {
        ++number;
        if (!read(line, q, dq)) {
            return std::fprintf(stderr, "line %d is not a state\n", number), 2;
        }
        const auto found =
            panda::speed_factor(q, dq, chest.value.force_limit, chest.value, p);
        std::printf("%.6f %s\n", found ? static_cast<double>(found.value.factor) : 0.0, found.text());
    }
    return 0;
}
