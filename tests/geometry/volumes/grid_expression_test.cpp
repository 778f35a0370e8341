// Grids in expressions: values, bounds, and what is wrong where.
#include "geometry/fields/expression.h"
#include "geometry/fields/grid.h"
#include "geometry/volumes/brick_grid.h"
#include "tests/geometry/volumes/function_voxels.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace meristem {
namespace {

// "slope" is x + 2 y + 3 z, in "slope" and in its grid "half" half as much.
class TestGrids final : public GridSource {
 public:
  std::shared_ptr<const Grid> open(const std::string& name, const std::string& grid) override {
    if (name != "slope") throw std::runtime_error("no grid named " + name);
    return grid == "half" ? half_ : whole_;
  }

 private:
  static std::shared_ptr<const Grid> make(float factor) {
    return std::make_shared<const BrickGrid>(test::FunctionVoxels(
        {-30, -30, -30}, {30, 30, 30}, [factor](int x, int y, int z) { return factor * float(x + 2 * y + 3 * z); }));
  }
  std::shared_ptr<const Grid> whole_ = make(1), half_ = make(0.5f);
};

const Symbols& symbols() {
  static const Symbols list = [] {
    Symbols s;
    s.add("P", ValueType::Vector);
    return s;
  }();
  return list;
}

std::shared_ptr<const Expression> compiled(const std::string& text, ValueType type = ValueType::Scalar) {
  TestGrids grids;
  const GridScope scope(&grids);
  return Expression::compile(text, symbols(), type);
}

TEST(GridExpression, SamplesByName) {
  const std::array<Vec3f, 1> p{Vec3f{1.5f, 2, -1}};
  EXPECT_FLOAT_EQ(compiled("vdb('slope', P)")->evaluate_scalar(p), 2.5f);
  EXPECT_FLOAT_EQ(compiled("vdb(\"slope\", P, 'half') + 1")->evaluate_scalar(p), 2.25f);
  EXPECT_FLOAT_EQ(compiled("vdb('slope', [1, 1, 1])")->evaluate_scalar(p), 6);
  EXPECT_EQ(compiled("vdb('slope', [99, 0, 0])")->evaluate_scalar(p), 0);
  const Vec3f g = compiled("vdb_gradient('slope', P)", ValueType::Vector)->evaluate_vector(p);
  EXPECT_NEAR(g.x, 1, 1e-4);
  EXPECT_NEAR(g.y, 2, 1e-4);
  EXPECT_NEAR(g.z, 3, 1e-4);
}

TEST(GridExpression, GivesTheSameBitsForABlockAndForSinglePoints) {
  const auto e = compiled("v = vdb_gradient('slope', 7*P); vdb('slope', P) + v[1]*fbm(P)");
  constexpr int count = 1000;
  std::vector<float> x(count), y(count), z(count), result(count);
  for (int i = 0; i < count; ++i) {
    const std::size_t k = std::size_t(i);
    x[k] = 0.031f * float(i), y[k] = -0.017f * float(i), z[k] = 5 - 0.003f * float(i);
  }
  const Input input{x.data(), y.data(), z.data(), 1};
  e->evaluate({count, {&input, 1}}, result.data(), nullptr, nullptr);
  for (std::size_t i = 0; i < count; ++i) {
    const std::array<Vec3f, 1> p{Vec3f{x[i], y[i], z[i]}};
    ASSERT_EQ(result[i], e->evaluate_scalar(p));
  }
}

TEST(GridExpression, IsBoundedOverABox) {
  const std::array<IntervalValue, 1> box{IntervalValue{{1.1f, 1.5f}, {2.1f, 2.5f}, {-0.9f, -0.5f}}};
  const Interval i = compiled("vdb('slope', P)")->evaluate_bounds(box).x;
  EXPECT_NEAR(i.lower, 2, 1e-3);  // of the samples around: x in 1..2, y in 2..3, z in -1..0
  EXPECT_NEAR(i.upper, 8, 1e-3);
  const IntervalValue g = compiled("vdb_gradient('slope', P)", ValueType::Vector)->evaluate_bounds(box);
  EXPECT_LE(g.z.lower, 3);
  EXPECT_GE(g.z.upper, 3);
  EXPECT_LE(g.z.upper, 30);
}

TEST(GridExpression, MistakesPointIntoTheText) {
  struct Mistake {
    const char* text;
    const char* message;
    std::size_t offset;
  };
  for (const Mistake& m :
       {Mistake{"1 + vdb('slop', P)", "no grid named slop", 8},
        Mistake{"vdb(P, P)", "argument 1 must be a text such as 'rock.vdb': vdb('name', v, 'grid')", 4},
        Mistake{"vdb('slope', 'P')", "argument 2 must be a value, not a text: vdb('name', v, 'grid')", 13},
        Mistake{"vdb('slope', 1)", "argument 2 must be a vector, not a scalar: vdb('name', v, 'grid')", 13},
        Mistake{"1 + 'slope'", "a text can only be an argument of a function such as vdb", 4},
        Mistake{"vdb('slope, P)", "the text has no end; expected '", 4}}) {
    try {
      compiled(m.text);
      ADD_FAILURE() << m.text << " compiled";
    } catch (const ExpressionError& e) {
      EXPECT_STREQ(e.what(), m.message);
      EXPECT_EQ(e.offset, m.offset) << m.text;
    }
  }
  EXPECT_THROW(Expression::compile("vdb('slope', P)", symbols(), ValueType::Scalar), ExpressionError);  // no scope
}

}  // namespace
}  // namespace meristem
