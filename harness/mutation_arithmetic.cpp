// SPDX-License-Identifier: GPL-3.0-or-later
// Files that compute something by themselves, against C++: the questions to the driver that run them, digests of MD5,
// texels of noise, and sums of samples.
#include "harness/mutation_oracles.h"
#include "tracer/accumulator.h"
#include "tracer/driver_cases.h"
#include "tracer/small_pass.h"

namespace plumbline {
namespace {

/// A driver case as an oracle of the file that it runs.
MutationOracle driver_oracle(GlContext& context, const char* name, std::vector<std::string_view> files) {
  MutationOracle oracle;
  oracle.name = std::string("driver.") + name;
  const std::array<ShaderDefine, 2> defines{ShaderDefine{"PASS_CONSTANT", "flat in"}, ShaderDefine{"RANDOM_HASH", ""}};
  oracle.programs.push_back(active_lines(compose_shader(files, defines)));
  oracle.ask = [&context, name](const Mutant&) {
    DriverCase asked;
    asked.name = name;
    const DriverResult result = run_driver_case(context, asked);
    return result.found ? result.detail : std::string();
  };
  return oracle;
}

}  // namespace

std::vector<MutationOracle> arithmetic_oracles(GlContext& context) {
  std::vector<MutationOracle> oracles;
  oracles.push_back(driver_oracle(context, "exact_arithmetic", {"exact.glsl"}));
  oracles.push_back(driver_oracle(context, "elementary", {"elementary.glsl"}));
  oracles.push_back(driver_oracle(context, "hash", {"random.glsl"}));
  return oracles;
}

}  // namespace plumbline
