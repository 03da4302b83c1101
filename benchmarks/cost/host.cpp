// SPDX-License-Identifier: BSD-3-Clause
// Times contenders in turns, so that what the machine does meanwhile hits all alike.
//
// Standard input: microseconds a batch, batches; the robot (pinocchio_arm.hpp); then samples, those
// that hit something last. Prints for each contender: quantity, name, largest difference, and
// nanoseconds a call in the fastest of its batches, which is the one that nothing disturbed; an
// impact is long enough to be a batch of its own.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <functional>
#include <iostream>
#include <numeric>
#include <string>
#include <vector>

#include "contenders.h"
#include "pinocchio_arm.hpp"
#include "rk4.h"

using Clock = std::chrono::steady_clock;
using Samples = std::vector<sample>;
using Call = std::function<void(const sample&, double*)>;

constexpr int largest = PANDA_JOINTS * PANDA_JOINTS;
constexpr double exact = 1e-9, integrated = 1e-3;
// Forces of both safe speeds lie between the same shares, and grow no slower than speeds.
constexpr double aimed = RK4_KEPT / RK4_NEAR - 1 + 2 * integrated;

struct Contender {
  std::string quantity, name;
  Call call;
  std::vector<double> fastest = {};  // ns a call, in each group of samples
};

static Samples readSamples(std::istream& in) {
  int count = 0;
  in >> count;
  Samples samples(count);
  for (sample& s : samples) {
    panda_default_params(&s.p);
    s.p.motors = PANDA_MOTORS_FREE;
    s.p.horizon = 0.1;
    int part = 0, clamped = 0;
    for (double* v : {s.q, s.n, s.p.joint_stiffness, s.p.rotor_inertia, s.p.position_gain})
      for (int i = 0; i < (v == s.n ? 3 : PANDA_JOINTS); ++i) in >> v[i];
    in >> part >> clamped >> s.speed >> s.force;
    panda_body_region(part, clamped, &s.region);
  }
  return samples;
}

static std::vector<Contender> contenders(PinocchioArm& arm, const double& share) {
  const char *const us = "ours", *const pin = "Pinocchio", *const rk4 = "RK4";
  std::vector<Contender> all = {
      {"mass_matrix", us, [](const sample& s, double* out) {
         panda_mass_matrix(s.q, reinterpret_cast<double (*)[PANDA_JOINTS]>(out));
       }},
      {"osim", us, [](const sample& s, double* out) {
         panda_osim_t r;
         panda_osim(s.q, &s.p, &r);
         std::memcpy(out, &r, sizeof r);
       }},
      {"reflected_mass", us,
       [](const sample& s, double* out) { panda_reflected_mass(s.q, s.n, out); }},
      {"reduced_model", us, [](const sample& s, double* out) {
         panda_reduced_model_t r;
         panda_reduced_model(s.q, s.n, &s.p, &r);
         std::memcpy(out, &r, sizeof r);
       }},
      {"giaf", us, [](const sample& s, double* out) {
         panda_giaf_t r;
         panda_giaf(s.q, &s.p, &r);
         std::memcpy(out, &r, sizeof r);
       }},
      {"peak_force", us, [](const sample& s, double* out) {
         panda_peak_force_t r = {0, 0};
         panda_peak_force(s.q, s.n, s.speed, &s.region, &s.p, &r);
         out[0] = r.force;
       }},
      {"safe_speed", us, [](const sample& s, double* out) {
         panda_safe_speed_t r = {0, 0};
         panda_safe_speed(s.q, s.n, s.region.force_limit, &s.region, &s.p, &r);
         out[0] = r.speed;
       }},
      {"mass_matrix", pin, [&](const sample& s, double* out) { arm.massMatrix(s, out); }},
      {"osim", pin, [&](const sample& s, double* out) { arm.osim(s, out); }},
      {"reflected_mass", pin, [&](const sample& s, double* out) { arm.reflectedMass(s, out); }},
      {"reduced_model", pin, [&](const sample& s, double* out) { arm.reducedModel(s, out); }},
      {"giaf", pin, [&](const sample& s, double* out) { arm.giaf(s, out); }},
      {"peak_force", rk4,
       [&](const sample& s, double* out) { out[0] = rk4_peak_force(&s, share); }},
      {"safe_speed", rk4, [&](const sample& s, double* out) {
         out[0] = rk4_safe_speed(&s, s.region.force_limit, share);
       }},
  };
#define GENERATED(quantity, name, function)                                                \
  all.push_back({quantity, name, [](const sample& s, double* out) {                        \
                   static long long iw[WORK];                                              \
                   static double w[WORK];                                                  \
                   const double* in[] = {s.q, s.n, s.p.joint_stiffness, s.p.rotor_inertia, \
                                         s.p.position_gain};                               \
                   function(in, &out, iw, w, 0);                                           \
                 }});
  CONTENDERS(GENERATED)
  return all;
}

// Largest difference of an entry over its size, or over a thousandth of the largest entry's.
static double difference(const Samples& samples, const Call& left, const Call& right) {
  double found = 0;
  for (const sample& s : samples) {
    double a[largest] = {0}, b[largest] = {0}, scale = 0;
    left(s, a);
    right(s, b);
    for (double entry : b) scale = std::max(scale, 1e-3 * std::abs(entry));
    for (int i = 0; i < largest; ++i) {
      const double off = std::abs(a[i] - b[i]) / std::max(scale, std::abs(b[i]));
      found = off <= found ? found : off;  // keeps what is not a number
    }
  }
  return found;
}

// Nanoseconds a call in a batch of about `target` nanoseconds.
static double time(const Samples& samples, const Call& call, double target) {
  double out[largest];
  volatile double sink = 0;
  for (int rounds = 1;; rounds *= 2) {
    const auto start = Clock::now();
    for (int round = 0; round < rounds; ++round)
      for (const sample& s : samples) {
        call(s, out);
        sink = out[0];
      }
    const std::chrono::duration<double, std::nano> taken = Clock::now() - start;
    if (taken.count() >= target) return taken.count() / (rounds * double(samples.size()));
  }
}

// Largest share with which RK4 is as accurate as we promise to be.
static double calibrate(const Samples& impacts) {
  const Call right = [](const sample& s, double* out) { out[0] = s.force; };
  for (double share = 2.7;; share /= 1.25) {
    const Call rk4 = [&](const sample& s, double* out) { out[0] = rk4_peak_force(&s, share); };
    if (difference(impacts, rk4, right) < integrated || share < 1e-3) return share;
  }
}

int main() {
  double microseconds = 0;
  int batches = 0;
  std::cin >> microseconds >> batches;
  PinocchioArm arm(std::cin);
  const Samples still = readSamples(std::cin), impacts = readSamples(std::cin);
  if (!std::cin) return 2;

  const double share = calibrate(impacts);
  std::vector<Contender> all = contenders(arm, share);
  const auto ours = [&](const Contender& c) -> const Contender& {
    return *std::find_if(all.begin(), all.end(),
                         [&](const Contender& o) { return o.quantity == c.quantity; });
  };
  const auto hits = [](const Contender& c) {
    return c.quantity == "peak_force" || c.quantity == "safe_speed";
  };
  std::vector<Samples> one = {still}, each;
  for (const sample& s : impacts) each.push_back({s});
  for (int batch = 0; batch < batches; ++batch)
    for (Contender& c : all) {
      const std::vector<Samples>& groups = hits(c) ? each : one;
      c.fastest.resize(groups.size(), 1e30);
      for (size_t i = 0; i < groups.size(); ++i)
        c.fastest[i] = std::min(c.fastest[i], time(groups[i], c.call, 1e3 * microseconds));
    }

  const Call sundials = [](const sample& s, double* out) { out[0] = s.force; };
  int wrong = 0;
  for (const Contender& c : all) {
    const Call& right = c.quantity == "peak_force" ? sundials : ours(c).call;
    const double off = difference(hits(c) ? impacts : still, c.call, right);
    wrong += !(off < (c.quantity == "safe_speed" ? aimed : hits(c) ? 2 * integrated : exact));
    std::printf("%s %s %.3g %.6g\n", c.quantity.c_str(), c.name.c_str(), off,
                std::accumulate(c.fastest.begin(), c.fastest.end(), 0.0) / c.fastest.size());
  }
  return wrong ? 1 : 0;
}
