// The evaluator: same bits for any instruction set, any split into blocks, any place of a lane and any thread.
#include "tests/geometry/fields/expression_support.h"

#include <gtest/gtest.h>

#include <cstring>
#include <immintrin.h>
#include <thread>

namespace meristem {
namespace {

using namespace test;

bool same_bits(const Results& a, const Results& b) {
  for (std::size_t c = 0; c < 3; ++c)
    if (std::memcmp(a[c].data(), b[c].data(), a[c].size() * sizeof(float)) != 0) return false;
  return true;
}

Results run(const Program& program, const KernelTable& kernels, const Points& points, std::size_t piece) {
  Results r;
  for (auto& c : r) c.resize(points.size());
  for (std::size_t start = 0; start < points.size(); start += piece) {
    const auto inputs = points.inputs(start);
    const int count = int(std::min(piece, points.size() - start));
    program.run(kernels, {count, inputs, points.keys.data() + start, 77}, r[0].data() + start, r[1].data() + start,
                r[2].data() + start);
  }
  return r;
}

TEST(Evaluation, HasTheSameBitsOnEveryInstructionSetAndForAnySplit) {
  const Points points(1003, 5, 3);
  for (const std::string& text : all_operations()) {
    const ParsedExpression parsed = parse_expression(text, variables(), ValueType::Vector);
    const Program program(parsed.graph, parsed.result);
    const Results whole = run(program, baseline_kernels(), points, points.size());
    for (std::size_t piece : {1, 7, 64, 300})
      EXPECT_TRUE(same_bits(whole, run(program, baseline_kernels(), points, piece))) << text << " in " << piece;
    for (const KernelTable* kernels : usable_kernels())
      EXPECT_TRUE(same_bits(whole, run(program, *kernels, points, points.size()))) << text << " by " << kernels->name;
  }
}

TEST(Evaluation, OfUniformInputsIsThatOfVaryingOnes) {
  const Points points(300, 6, 3);
  for (const std::string& text : all_operations()) {
    const auto e = Expression::compile(text, variables(), ValueType::Vector);
    const Results varying = evaluate(*e, points, 5);
    for (std::size_t i : {0u, 150u, 299u}) {
      const Vec3f one = e->evaluate_vector(points.at(i), points.keys[i], 5);
      const Results single{{{one.x}, {one.y}, {one.z}}}, expected{{{varying[0][i]}, {varying[1][i]}, {varying[2][i]}}};
      EXPECT_TRUE(same_bits(single, expected)) << text;
    }
  }
}

TEST(Evaluation, MixesUniformAndVaryingInputs) {
  const Points points(600, 2, 3);
  const auto e = Expression::compile("a = sin(x) + fbm(P); b = a * y; b * N + rand()", variables(), ValueType::Vector);
  const Results varying = evaluate(*e, points, 1);
  Points copy = points;
  for (std::size_t i = 0; i < copy.size(); ++i) {
    copy.columns[0][0][i] = points.columns[0][0][9];
    for (std::size_t c = 0; c < 3; ++c) copy.columns[3][c][i] = points.columns[3][c][9];
  }
  auto inputs = copy.inputs();
  inputs[0].stride = inputs[3].stride = 0;
  Results mixed;
  for (auto& c : mixed) c.resize(copy.size());
  e->evaluate({int(copy.size()), inputs, copy.keys.data(), 1}, mixed[0].data(), mixed[1].data(), mixed[2].data());
  EXPECT_TRUE(same_bits(mixed, evaluate(*e, copy, 1)));
  EXPECT_FALSE(same_bits(mixed, varying));
}

TEST(Evaluation, GivesTheSameOnManyThreads) {
  const Points points(3000, 8, 4);
  const auto e = Expression::compile("vfbm(P) * rand() + [sin(x), exp(y), pow(z, x)]", variables(), ValueType::Vector);
  const Results expected = evaluate(*e, points, 3);
  std::array<bool, 4> same{};
  std::vector<std::thread> threads;
  for (bool& s : same)
    threads.emplace_back([&] {
      s = true;
      for (int i = 0; i < 20; ++i) s = s && same_bits(evaluate(*e, points, 3), expected);
    });
  for (std::thread& t : threads) t.join();
  for (bool s : same) EXPECT_TRUE(s);
}

TEST(Evaluation, DoesNotDependOnTheCallersFloatMode) {
  const Points points(100, 8, 4);
  const auto e = Expression::compile("x * 1e-38 * y", variables(), ValueType::Scalar);
  const Results expected = evaluate(*e, points);
  const unsigned mode = _mm_getcsr();
  _mm_setcsr(mode ^ 0xe040);  // another rounding, other treatment of denormals
  const Results other = evaluate(*e, points);
  _mm_setcsr(mode);
  EXPECT_TRUE(same_bits(expected, other));
}

TEST(Evaluation, OfNothingTouchesNothing) {
  const auto e = Expression::compile("x", variables(), ValueType::Scalar);
  e->evaluate({}, nullptr, nullptr, nullptr);
}

// What the compiler knows

TEST(Compilation, SharesCommonSubexpressions) {
  const ParsedExpression parsed = parse_expression("sin(x*y) + sin(y*x) * sin(x*y)", variables(), ValueType::Scalar);
  EXPECT_EQ(Program(parsed.graph, parsed.result).instruction_count(), 4u);  // x*y, sin, *, +
}

TEST(Compilation, LeavesOutWhatNobodyReads) {
  const ParsedExpression parsed = parse_expression("a = fbm(P); b = (P * x)[1]; b", variables(), ValueType::Scalar);
  const Program program(parsed.graph, parsed.result);
  EXPECT_EQ(program.instruction_count(), 1u);
  EXPECT_TRUE(program.uses(0));
  EXPECT_FALSE(program.uses(4));
}

TEST(Compilation, FoldsConstants) {
  const auto e =
      Expression::compile("a = [1, 2, 3]; length(a * 2) + sin(PI / 2) + fbm(a)", variables(), ValueType::Scalar);
  EXPECT_TRUE(e->is_constant());
  EXPECT_FALSE(Expression::compile("x * 0", variables(), ValueType::Scalar)->is_constant());
}

TEST(Compilation, ReusesRegisters) {
  std::string text = "a = x;";
  for (int i = 0; i < 200; ++i) text += "a = sin(a) + y;";
  const ParsedExpression parsed = parse_expression(text + "a", variables(), ValueType::Scalar);
  EXPECT_LE(Program(parsed.graph, parsed.result).register_count(), 5u);
}

}  // namespace
}  // namespace meristem
