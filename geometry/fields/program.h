// Program: a graph as a list of kernel calls over registers, run over blocks of points in runs of `run_lanes`.
// Only what the result needs is in it, component by component. What depends on uniform inputs alone is done once a
// block. Immutable; any thread may run it. The graph must outlive it if it has grids. Registers are per thread and grow
// to the largest program run.
#pragma once

#include "geometry/fields/graph.h"

#include <array>
#include <vector>

namespace meristem {

class Program {
 public:
  static constexpr int run_lanes = 256;

  Program(const Graph& graph, NodeId result);
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void run(const KernelTable& kernels, const Block& block, float* x, float* y, float* z) const;

  // One point, with the bits of a block of one: values[slot] of the inputs (scalars in x). Beside the kernels it takes
  // a sixth of run()'s time, since each thread keeps the calls of its latest programs with all their pointers.
  Vec3f run_one(const KernelTable& kernels, std::span<const Vec3f> values, Key key, Key salt) const;

  bool uses(int slot) const;
  bool uses_random() const { return uses_random_; }
  std::size_t instruction_count() const { return instructions_.size(); }
  std::size_t register_count() const { return register_count_; }

 private:
  // Where a scalar value comes from: an index into constants_, inputs_ or the results of instructions.
  struct Source {
    enum class Kind : std::uint8_t { Constant, Input, Value };
    Kind kind = Kind::Constant;
    std::int32_t index = 0;
    bool operator==(const Source&) const = default;
  };
  struct InputUse {
    int slot, component;
    std::int32_t register_index = 0;
  };
  struct Instruction {
    Op op = Op::Constant;
    std::int32_t parameter = 0;
    std::int32_t curve = -1;
    const Grid* grid = nullptr;  // owned by the graph
    std::int32_t first_operand = 0, operand_count = 0;
    std::int32_t first_value = 0, value_count = 0;
  };
  struct InputOperand {
    std::int32_t input, operand;
  };
  using Sources = std::array<Source, 3>;
  struct Scratch;
  struct Bindings;
  struct Frame;

  std::vector<std::uint8_t> needed_components(const Graph& graph, NodeId result) const;
  void emit(const Graph& graph, const Node& node, std::uint8_t needed, std::vector<Sources>& sources);
  void emit_call(const Graph& graph, const Node& node, std::span<const Source> operands, int value_count);
  Source constant(float value);
  Source input(int slot, int component);
  void assign_registers();

  void make_frame(Frame& frame) const;
  void bind_inputs(Bindings& bindings, const Block& block, int start, int count, int group) const;
  void run_calls(const KernelTable& kernels, const Block& block, const Scratch& scratch, int start, int count) const;

  const std::uint64_t number_;  // of all programs that there were; from 1
  std::vector<float> constants_;
  std::vector<InputUse> inputs_;
  std::vector<Instruction> instructions_;
  std::vector<Source> operands_;
  std::vector<InputOperand> input_operands_;   // which of them are inputs
  std::vector<std::int32_t> value_registers_;  // by value: its register in runs
  std::vector<CurveTable> curves_;
  Sources result_;
  int result_components_ = 1;
  std::size_t register_count_ = 0;
  bool uses_random_ = false;
};

}  // namespace meristem
