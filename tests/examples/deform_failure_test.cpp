// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
// What the example `deform` says and leaves behind when its input is wrong or a step fails.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <ostream>
#include <string>

#include "examples/run_deform.hpp"

namespace softsim::test {
namespace deform_failure_test {

/// A Gmsh file with the given lines of nodes and elements.
std::string gmsh(const Words& nodes, const Words& elements) {
  std::string text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" + std::to_string(nodes.size()) + "\n";
  for (const std::string& line : nodes) text += line + "\n";
  text += "$EndNodes\n$Elements\n" + std::to_string(elements.size()) + "\n";
  for (const std::string& line : elements) text += line + "\n";
  return text + "$EndElements\n";
}

const Words corners{"1 0 0 0", "2 1 0 0", "3 0 1 0", "4 0 0 1"};
const Words two_pieces = corners + Words{"5 3 0 0", "6 4 0 0", "7 3 1 0", "8 3 0 1"};

/// Mesh files that something is wrong with, and some that are right.
void write_meshes(const TemporaryFolder& folder) {
  const std::string tetrahedron = gmsh(corners, {"1 4 2 1 1 1 2 3 4"});
  folder.write("one.msh", tetrahedron);
  folder.write("empty.msh", "");
  folder.write("binary.msh", std::string("$MeshFormat\n\0\1\2\3", 16));
  folder.write("marked_binary.msh", replaced(tetrahedron, "2.2 0 8", "2.2 1 8"));
  folder.write("truncated.msh", tetrahedron.substr(0, tetrahedron.find("3 0 1 0")));
  folder.write("cut_element.msh", tetrahedron.substr(0, tetrahedron.find(" 3 4\n$EndElements")));
  folder.write("count.msh", replaced(tetrahedron, "$Nodes\n4", "$Nodes\n5"));
  folder.write("nan.msh", replaced(tetrahedron, "3 0 1 0", "3 0 nan 0"));
  folder.write("range.msh", replaced(tetrahedron, "1 2 3 4", "1 2 3 9"));
  folder.write("repeated.msh", replaced(tetrahedron, "1 2 3 4", "1 2 3 3"));
  folder.write("inverted.msh", replaced(tetrahedron, "1 2 3 4", "1 3 2 4"));
  folder.write("flat.msh", replaced(tetrahedron, "4 0 0 1", "4 1 1 0"));
  folder.write("triangle.msh", gmsh(corners, {"1 2 2 1 1 1 2 3"}));
  folder.write("other.stl", "solid\nendsolid\n");
  folder.write("two_pieces.msh", gmsh(two_pieces, {"1 4 2 1 1 1 2 3 4", "2 4 2 1 1 5 6 7 8"}));
  // Two tetrahedra that stand on points of one line.
  folder.write("line.msh",
               gmsh({"1 0 0 0", "2 1 0 0", "3 2 0 0", "4 0.5 -1 1", "5 0.5 1 1", "6 1.5 -1 1", "7 1.5 1 1"},
                    {"1 4 2 1 1 1 2 5 4", "2 4 2 1 1 2 3 7 6"}));
  std::filesystem::create_directory(folder.path("folder.msh"));
}

struct BadInput {
  std::string name, arguments;  ///< in the order of the line, words with spaces between them
  Words said;                   ///< what the one line on stderr must contain
};
void PrintTo(const BadInput& bad, std::ostream* stream) { *stream << bad.arguments; }

const std::string most = " --young 1e4 --poisson 0.4 --density 1000 --fix zmin --no-picture";
const std::string all = " --material svk" + most;
const std::string organ = DEFORM_ORGAN + all;

// clang-format off
const BadInput bad_inputs[] = {
    {"missing_mesh", "missing.msh" + all, {"missing.msh", "No such file"}},
    {"empty_mesh", "empty.msh" + all, {"empty.msh", "empty"}},
    {"folder_as_mesh", "folder.msh" + all, {"folder.msh"}},
    {"binary_mesh", "binary.msh" + all, {"binary.msh, line 2", "binary"}},
    {"mesh_marked_binary", "marked_binary.msh" + all, {"marked_binary.msh, line 2", "binary"}},
    {"truncated_mesh", "truncated.msh" + all, {"truncated.msh, line 5", "number of nodes"}},
    {"element_cut_off", "cut_element.msh" + all, {"cut_element.msh, line 13", "node number"}},
    {"wrong_count", "count.msh" + all, {"count.msh, line 10", "node 5 of 5"}},
    {"nan_coordinate", "nan.msh" + all, {"nan.msh, line 8", "nan"}},
    {"node_out_of_range", "range.msh" + all, {"range.msh, line 13", "9"}},
    {"node_repeated", "repeated.msh" + all, {"repeated.msh, line 13", "3"}},
    {"inverted_tetrahedron", "inverted.msh" + all,
     {"inverted.msh, line 13", "tetrahedron 0", "-0.166666667"}},
    {"flat_tetrahedron", "flat.msh" + all, {"flat.msh, line 13", "tetrahedron 0", "volume 0"}},
    {"no_tetrahedra", "triangle.msh" + all, {"triangle.msh", "no tetrahedra"}},
    {"unknown_ending", "other.stl" + all, {"other.stl", ".vtu"}},
    {"two_meshes", organ + " one.msh", {"one.msh", "only one mesh"}},

    {"young_zero", organ + " --young 0", {"young 0"}},
    {"young_negative", organ + " --young -5", {"young -5"}},
    {"young_not_a_number", organ + " --young soft", {"--young", "soft"}},
    {"young_nan", organ + " --young nan", {"--young", "nan"}},
    {"young_with_a_tail", organ + " --young 1e4Pa", {"--young", "1e4Pa"}},
    {"poisson_half", organ + " --poisson 0.5", {"poisson", "0.5"}},
    {"poisson_minus_one", organ + " --poisson -1", {"poisson", "-1"}},
    {"density_zero", organ + " --density 0", {"density 0"}},
    {"density_negative", organ + " --density -1060", {"density -1060"}},
    {"region_that_is_not_there", organ + " --region 7:1e4,0.3", {"--region 7"}},
    {"region_with_bad_young", organ + " --region 2:-3,0.3", {"-3"}},
    {"region_incomplete", organ + " --region 2:1e4", {"--region"}},
    {"material_unknown", organ + " --material rubber", {"--material rubber", "neo-hookean"}},
    {"fix_unknown_side", organ + " --fix left", {"--fix left", "xmin"}},
    {"fix_depth_negative", organ + " --fix-depth -0.1", {"depth -0.1"}},
    {"fix_depth_above_one", organ + " --fix-depth 2", {"depth 2"}},
    {"gravity_of_two_numbers", organ + " --gravity 0,-9.81", {"--gravity 0,-9.81", "3"}},
    {"pull_of_two_numbers", organ + " --pull xmax:1,2", {"--pull", "1,2"}},
    {"pull_without_a_force", organ + " --pull xmax", {"--pull xmax"}},
    {"pull_unknown_side", organ + " --pull top:1,2,3", {"--pull top"}},
    {"mass_unknown", organ + " --mass heavy", {"--mass heavy", "consistent"}},
    {"integrator_unknown", organ + " --integrator rk4", {"--integrator rk4", "semi-explicit"}},
    {"tolerance_zero", organ + " --tolerance 0", {"--tolerance 0"}},
    {"tolerance_negative", organ + " --tolerance -1e-6", {"--tolerance -1e-06"}},
    {"scale_zero", organ + " --scale 0", {"--scale 0"}},
    {"scale_negative", organ + " --scale -1", {"--scale -1"}},
    {"rayleigh_of_one_number", organ + " --rayleigh 1", {"--rayleigh 1"}},
    {"rayleigh_negative", organ + " --rayleigh 0,-1", {"--rayleigh 0,-1"}},
    {"write_every_zero", organ + " --write-every 0", {"--write-every 0"}},

    {"dt_zero", organ + " --steps 3 --dt 0", {"dt 0"}},
    {"dt_negative", organ + " --steps 3 --dt -0.01", {"dt -0.01"}},
    {"dt_infinite", organ + " --steps 3 --dt inf", {"--dt inf"}},
    {"steps_zero", organ + " --steps 0 --dt 0.01", {"--steps 0"}},
    {"steps_negative", organ + " --steps -2 --dt 0.01", {"--steps -2"}},
    {"steps_not_whole", organ + " --steps 2.5 --dt 0.01", {"--steps 2.5"}},
    {"steps_without_dt", organ + " --steps 3", {"--dt"}},
    {"dt_without_steps", organ + " --dt 0.01", {"--steps"}},
    {"static_with_steps", organ + " --static --steps 3 --dt 0.01", {"--static", "--steps"}},
    {"newton_with_semi_explicit", organ + " --steps 3 --dt 1e-4 --newton --integrator semi-explicit",
     {"--newton"}},

    {"unknown_option", organ + " --bogus", {"--bogus"}},
    {"unknown_option_with_value", organ + " --bogus=3", {"--bogus"}},
    {"option_without_value", organ + " --gravity", {"--gravity", "value"}},
    {"flag_with_value", organ + " --static=yes", {"--static"}},
    {"no_material", DEFORM_ORGAN + most, {"--material", "required"}},
    {"only_a_mesh", DEFORM_ORGAN, {"required"}},
    {"shipped_organ_with_bad_density", "--no-picture --density 0", {"density 0"}},

    {"held_at_one_node", organ + " --static --fix-depth 0", {"--fix took 1 node", "three"}},
    {"held_along_a_line", "line.msh" + all + " --static", {"--fix took 3 nodes", "line"}},
    {"a_piece_not_held",
     "two_pieces.msh --material svk --young 1e4 --poisson 0.4 --density 1000 --static --fix xmin",
     {"--fix took 3 nodes", "piece 1"}},
};
// clang-format on

class ABadInput : public ::testing::TestWithParam<BadInput> {};

/// Exit code 2 and one line that contains the fragments.
void expect_refusal(const Ended& ended, const Words& fragments) {
  EXPECT_EQ(ended.code, 2);
  EXPECT_EQ(ended.out, "");
  EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
  EXPECT_TRUE(ended.err.starts_with("deform: ")) << ended.err;
  EXPECT_TRUE(ended.err.ends_with("\n"));
  for (const std::string& fragment : fragments)
    EXPECT_NE(ended.err.find(fragment), std::string::npos) << ended.err;
}

TEST_P(ABadInput, IsRefusedInOneLineAndLeavesNothing) {
  Deform deform;
  write_meshes(deform.folder);
  const std::size_t before = deform.folder.number_of_files();
  const BadInput& bad = GetParam();
  expect_refusal(deform.run(words("--out new/results " + bad.arguments)), bad.said);
  EXPECT_EQ(deform.folder.number_of_files(), before);
}
INSTANTIATE_TEST_SUITE_P(Table, ABadInput, ::testing::ValuesIn(bad_inputs),
                         [](const auto& bad) { return bad.param.name; });

TEST(DeformExample, WritesNothingBelowAFile) {
  Deform deform;
  deform.folder.write("file", "text");
  expect_refusal(deform.run(words(organ + " --out file")), {"file"});
  expect_refusal(deform.run(words(organ + " --out file/results")), {"file/results"});
  EXPECT_EQ(slurp(deform.folder.path("file")), "text");
  EXPECT_EQ(deform.folder.number_of_files(), 1U);
}

TEST(DeformExample, OlderResultsSurviveABadInput) {
  Deform deform;
  const Words run = words(organ + " --out out --gravity 0,0,-0.1 --fix-depth 0.2 --steps 2 --dt 0.01");
  ASSERT_EQ(deform.run(run).code, 0);
  const auto contents = [&] {
    std::map<std::string, std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(deform.folder.path("out")))
      files[entry.path().filename()] = slurp(entry.path());
    return files;
  };
  const auto before = contents();
  EXPECT_EQ(before.size(), 5U);  // three states, the .pvd and the summary
  for (const Words& bad : {Words{"--young", "0"}, {"--dt", "-1"}, {"--region", "9:1,0.1"}, {"--bogus"}})
    expect_refusal(deform.run(run + bad), {});
  EXPECT_EQ(contents(), before);
}

struct Failure {
  std::string name, arguments, status;
};
void PrintTo(const Failure& failure, std::ostream* stream) { *stream << failure.arguments; }

const std::string held =
    " --young 1e4 --poisson 0.4 --density 1060 --fix zmin --fix-depth 0.2 --no-picture --out out ";
const std::string soft = DEFORM_ORGAN + held + "--gravity 0,0,-9.81 ";
const Failure failures[] = {
    // Far above the stable step, which is some 1e-3 s: neo-Hookean tetrahedra invert and their logarithm is
    // not a number.
    {"explicit_step_too_large",
     soft + "--material neo-hookean --integrator semi-explicit --steps 20 --dt 0.01", "not_finite"},
    {"explicit_step_too_large_between_writes",
     soft + "--material neo-hookean --integrator semi-explicit --steps 20 --dt 0.01 --write-every 7",
     "not_finite"},
    {"explicit_step_too_large_consistent_mass",
     soft + "--material neo-hookean --integrator semi-explicit --mass consistent --steps 20 --dt 0.03",
     "not_finite"},
    {"explicit_overflow", soft + "--material svk --integrator semi-explicit --steps 500 --dt 0.01",
     "not_finite"},
    {"linearised_step_that_inverts", soft + "--material neo-hookean --pull xmax:100,0,0 --steps 10 --dt 0.01",
     "not_converged"},
    {"newton_with_a_huge_load",
     soft + "--material neo-hookean --newton --pull xmax:1e8,0,0 --steps 3 --dt 0.01", "not_converged"},
    {"static_with_a_huge_load", soft + "--material neo-hookean --static --pull xmax:1e7,0,0",
     "not_converged"},
    // St. Venant-Kirchhoff softens under pressure
    {"equilibrium_inside_out", DEFORM_ORGAN + held + "--gravity 0,0,-100 --material svk --static",
     "inverted"},
    {"load_that_overflows", soft + "--material neo-hookean --static --pull xmax:1e300,0,0", "not_finite"},
};

class AFailingStep : public ::testing::TestWithParam<Failure> {};

TEST_P(AFailingStep, IsToldAndWhatWasWrittenStaysReadable) {
  Deform deform;
  const Ended ended = deform.run(words(GetParam().arguments));
  EXPECT_EQ(ended.code, 3) << ended.err;
  EXPECT_NE(ended.err.find(GetParam().status), std::string::npos) << ended.err;
  ASSERT_TRUE(std::filesystem::exists(deform.folder.path("out/summary.json")));
  const Summary s(deform.folder.path("out"));
  EXPECT_EQ(s.text("status"), '"' + GetParam().status + '"');
  EXPECT_NE(s.text("reason"), "\"\"");

  const Series series(deform.folder.path("out"));
  double last = -1;
  for (std::size_t k = 0; k < series.states.size(); ++k) {
    EXPECT_GT(series.times[k], last);
    last = series.times[k];
    EXPECT_EQ(series.states[k].vectors("Points").size(), 738U);
    EXPECT_EQ(series.states[k].vectors("displacement").size(), 738U);
    EXPECT_EQ(series.states[k].scalars("J").size(), 3013U);
  }
  for (const Vec3<double>& x : series.states.back().vectors("Points")) EXPECT_TRUE(x.allFinite());
  for (const auto& entry : std::filesystem::directory_iterator(deform.folder.path("out")))
    EXPECT_NE(entry.path().extension(), ".part") << entry.path();
}
INSTANTIATE_TEST_SUITE_P(Table, AFailingStep, ::testing::ValuesIn(failures),
                         [](const auto& failure) { return failure.param.name; });

}  // namespace deform_failure_test
}  // namespace softsim::test
