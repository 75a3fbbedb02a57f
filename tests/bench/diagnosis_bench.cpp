// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A whole diagnosis, the whole catalogue searched, of captures at 100 kS/s with VTEMP, VDD and a
// reference: seconds a run beside the seconds that it took to record, the growth with the samples,
// and the most memory that the process ever held, program and all, in sizes of the capture.
// Captures come from small to large, so that the last says it of the largest.

#include <random>

#include <sys/resource.h>

#include <benchmark/benchmark.h>

#include "diagnosis/captures.h"
#include "diagnosis/diagnose.h"

namespace {

void diagnose(benchmark::State &state) {
  constexpr double kRate = 100e3;
  std::mt19937_64 rng(1);
  ada::Model model = ada::test::sound_sensor();
  for (const char *effect : {"amplitude-mismatch:k=0.01", "quadrature-error:delta_deg=0.4",
                             "stray-field:b=0.01,direction_deg=40"})
    model.effects.push_back(ada::parse_effect(effect));
  ada::test::Drive drive;
  drive.samples = static_cast<std::size_t>(state.range(0));
  drive.rate_hz = kRate;
  drive.slow_rpm = 600.0;
  drive.fast_rpm = 1500.0;
  ada::Capture capture = ada::test::capture_of(model, drive, rng);
  std::normal_distribution<> noise(0.0, 2e-4);
  for (std::size_t i = 0; i < capture.size(); ++i) {
    capture.vtemp_v.push_back(1.5 + noise(rng));
    capture.vdd_v.push_back(5.0 + noise(rng));
  }
  for (auto *column : {&capture.vsin_v, &capture.vcos_v, &capture.time_s, &capture.vtemp_v,
                       &capture.vdd_v, &capture.reference_deg})
    column->shrink_to_fit();
  std::size_t found = 0;
  for (auto _ : state)
    found = ada::diagnose(capture, {}).findings.size();
  state.counters["found"] = static_cast<double>(found);
  state.counters["recorded_s"] = static_cast<double>(drive.samples) / kRate;
  rusage use{};
  getrusage(RUSAGE_SELF, &use);
  const double bytes = 6.0 * sizeof(double) * static_cast<double>(capture.size());
  state.counters["memory"] = 1024.0 * static_cast<double>(use.ru_maxrss) / bytes;
  state.SetComplexityN(state.range(0));
}

} // namespace

BENCHMARK(diagnose)
    ->RangeMultiplier(2)
    ->Range(125000, 1000000)
    ->Unit(benchmark::kMillisecond)
    ->Complexity(benchmark::oN);

BENCHMARK_MAIN();
