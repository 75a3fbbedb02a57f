// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Interleaved int16 pairs in, float angles out: 4 bytes read and 4 written a sample. In one run: a
// plain copy of the same traffic, scalar std::atan2, SLEEF, and the library on every instruction
// set that this processor has. Repetitions are drawn in random order and times are those of the
// processor, so that a busy machine slows all of them alike; compare medians.
//
//   conversion_bench
#include <cmath>
#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "ada4571.h"
#include "conversion/raw_converter.h"
#include "conversion/vector_kernels.h"
#include "sleef_loops.h"

namespace ada::bench {
namespace {

struct Data {
  std::vector<std::int16_t> pairs;
  std::vector<float> out, radius;
  explicit Data(std::size_t n) : pairs(2 * n), out(n), radius(n) {
    std::mt19937 rng(1);
    for (std::size_t i = 0; i < n; ++i) {
      const double psi = 6.283185307 * static_cast<double>(rng()) / 4294967296.0;
      pairs[2 * i] = static_cast<std::int16_t>(19000 * std::sin(psi));
      pairs[2 * i + 1] = static_cast<std::int16_t>(19000 * std::cos(psi));
    }
  }
};

/// One set of buffers a size, shared by all benchmarks.
Data &data(std::size_t n) {
  static Data large(20'000'000), small(16'384);
  return n == large.out.size() ? large : small;
}

/// Runs `body(data)` and counts samples.
template <class Body> void run(benchmark::State &state, Body body) {
  const auto n = static_cast<std::size_t>(state.range(0));
  Data &d = data(n);
  for (auto _ : state) {
    body(d, n);
    benchmark::DoNotOptimize(d.out.data());
    benchmark::ClobberMemory();
  }
  state.counters["Gsample/s"] =
      benchmark::Counter(static_cast<double>(n) * static_cast<double>(state.iterations()) * 1e-9,
                         benchmark::Counter::kIsRate);
}

Model calibrated() {
  Model m;
  m.baseline = {1.45, 0.031, -0.018, 12.0};
  return m;
}

const ada4571_layout kLayout = {sizeof(ada4571_layout), ADA4571_S16, 4, 5.0 / 65536, 32768, 0, 0};

void library(benchmark::State &state, const std::string &target, bool radius) {
  use_vector_target(target);
  const RawConverter converter{calibrated()};
  run(state, [&](Data &d, std::size_t n) {
    converter.convert(kLayout, d.pairs.data(), d.pairs.data() + 1, n, d.out.data(),
                      radius ? d.radius.data() : nullptr);
  });
  use_vector_target("");
}

benchmark::internal::Benchmark *sized(benchmark::internal::Benchmark *b) {
  return b->Arg(20'000'000)->Arg(16'384)->Unit(benchmark::kMillisecond);
}

void register_all() {
  sized(benchmark::RegisterBenchmark("copy", [](benchmark::State &state) {
    run(state, [](Data &d, std::size_t n) {
      std::memcpy(d.out.data(), d.pairs.data(), n * sizeof(float));
    });
  }));
  sized(benchmark::RegisterBenchmark("scalar_std_atan2", [](benchmark::State &state) {
    run(state, [](Data &d, std::size_t n) {
      for (std::size_t i = 0; i < n; ++i)
        d.out[i] = std::atan2(static_cast<float>(d.pairs[2 * i] - 7),
                              static_cast<float>(d.pairs[2 * i + 1] - 7));
    });
  }));
  if (have_avx2())
    sized(benchmark::RegisterBenchmark("sleef_u35_avx2", [](benchmark::State &state) {
      run(state, [](Data &d, std::size_t n) { sleef_avx2(d.pairs.data(), n, d.out.data()); });
    }));
  if (have_avx512())
    sized(benchmark::RegisterBenchmark("sleef_u35_avx512", [](benchmark::State &state) {
      run(state, [](Data &d, std::size_t n) { sleef_avx512(d.pairs.data(), n, d.out.data()); });
    }));
  for (const std::string &target : vector_targets()) {
    sized(benchmark::RegisterBenchmark(("library_" + target).c_str(), library, target, false));
    sized(benchmark::RegisterBenchmark(("library_with_radius_" + target).c_str(), library, target,
                                       true));
  }
}

} // namespace
} // namespace ada::bench

int main(int argc, char **argv) {
  std::vector<std::string> arguments(argv, argv + argc);
  arguments.insert(arguments.begin() + 1, {"--benchmark_repetitions=9", "--benchmark_min_time=0.05",
                                           "--benchmark_enable_random_interleaving=true",
                                           "--benchmark_report_aggregates_only=true"});
  std::vector<char *> pointers;
  for (std::string &a : arguments)
    pointers.push_back(a.data());
  int count = static_cast<int>(pointers.size());
  benchmark::Initialize(&count, pointers.data());
  if (benchmark::ReportUnrecognizedArguments(count, pointers.data()))
    return 2;
  ada::bench::register_all();
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
