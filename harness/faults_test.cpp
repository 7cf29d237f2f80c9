// SPDX-License-Identifier: GPL-3.0-or-later
// Every fault that is seeded on purpose is caught, by a verdict that tells of it.
#include "harness/faults.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <map>
#include <set>

using namespace plumbline;

/// The layers that may be blamed for each fault: what is broken, or what it looks like from the ray that fails.
const std::map<std::string, std::set<Layer>> kLayers{{"sphere_shrunk", {Layer::bounds}},
                                                     {"links_swapped", {Layer::links}},
                                                     {"radius_not_squared", {Layer::bounds}},
                                                     {"t_max_without_its_square", {Layer::bounds}},
                                                     {"edge_excluded", {Layer::primitive_arithmetic}},
                                                     {"first_hit", {Layer::primitive_arithmetic}},
                                                     {"behind_the_origin", {Layer::primitive_arithmetic}},
                                                     {"t_max_exclusive_by_far", {Layer::primitive_arithmetic}},
                                                     {"far_root_first", {Layer::primitive_arithmetic}},
                                                     {"normal_turned", {Layer::primitive_arithmetic}},
                                                     {"weights_exchanged", {Layer::primitive_arithmetic}},
                                                     {"cluster_cut_short", {Layer::primitive_arithmetic}},
                                                     {"t_off_by_1e-5", {Layer::primitive_arithmetic}},
                                                     {"transform_out_missing", {Layer::transform}},
                                                     {"out_by_the_matrix_of_in", {Layer::transform}},
                                                     {"normal_by_the_matrix", {Layer::transform}},
                                                     {"t_left_local", {Layer::transform}},
                                                     {"parents_matrix_only", {Layer::transform}},
                                                     {"sphere_not_refitted", {Layer::bounds}},
                                                     {"transform_behind_the_eye", {Layer::transform}},
                                                     {"instance_of_the_parent", {Layer::transform}},
                                                     {"nearest_of_another_ray", {Layer::none}}};

TEST_CASE("Each seeded fault is caught by a failing verdict, and its layer is told") {
  Session session;
  for (const Fault& fault : all_faults()) {
    INFO(fault.name << ": " << fault.what);
    const FaultResult result = run_fault(session, fault, 1);
    INFO("caught by " << result.caught_by);
    CHECK(is_failure(result.verdict));
    CHECK(std::find(fault.expected.begin(), fault.expected.end(), result.verdict) != fault.expected.end());
    INFO(name_of(result.layer) << ": " << result.sentence);
    REQUIRE(kLayers.contains(fault.name));
    CHECK(kLayers.at(fault.name).contains(result.layer));
    CHECK_FALSE(result.sentence.empty());
  }
}
