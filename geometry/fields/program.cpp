#include "geometry/fields/program.h"

#include "geometry/base/check.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstring>
#include <immintrin.h>
#include <memory>
#include <new>

namespace meristem {

namespace {

// Denormals are flushed and rounding is to nearest while it lives, whatever the caller's mode: same bits on every
// thread.
class FloatMode {
 public:
  FloatMode() : saved_(_mm_getcsr()) {
    _mm_setcsr(0x9fc0);
  }  // all exceptions masked, flush to zero, denormals are zero
  ~FloatMode() { _mm_setcsr(saved_); }
  FloatMode(const FloatMode&) = delete;
  FloatMode& operator=(const FloatMode&) = delete;

 private:
  unsigned saved_;
};

int component_count(const Graph& graph, NodeId id) { return graph.is_vector(id) ? 3 : 1; }

int padded(int lanes, int group) { return (lanes + group - 1) / group * group; }

// rand(): the top 24 bits of hash(key, salt, occurrence, seed).
void run_rand(const KernelCall& call, const Key* keys, Key salt, int count, int lanes) {
  for (int i = 0; i < lanes; ++i) {
    const Key key = keys ? keys[std::min(i, count - 1)] : 0;
    const float seed = call.operands[0].data[i & call.operands[0].step_mask] + 0.0f;
    call.out[0][i] = uniform_float(hash_keys(key, salt, Key(call.parameter), std::bit_cast<std::uint32_t>(seed)));
  }
}

void run_grid(Op op, const Grid& grid, const KernelCall& call, int lanes) {
  auto at = [&](int component, int i) { return call.operands[component].data[i & call.operands[component].step_mask]; };
  const bool uniform = std::all_of(call.operands, call.operands + 3, [](const Operand& o) { return o.step_mask == 0; });
  const int components = op == Op::GridValue ? 1 : 3;
  for (int i = 0; i < (uniform ? 1 : lanes); ++i) {
    const Vec3f place{at(0, i), at(1, i), at(2, i)};
    const Vec3f result = op == Op::GridValue ? Vec3f(grid.value(place)) : grid.gradient(place);
    for (int c = 0; c < components; ++c) call.out[std::size_t(c)][i] = result[c];
  }
  if (uniform)
    for (int c = 0; c < components; ++c)
      std::fill_n(call.out[std::size_t(c)] + 1, lanes - 1, call.out[std::size_t(c)][0]);
}

}  // namespace

// Floats that begin on a cache line, so that no vector of a run lies across two. Growing forgets what they were.
class AlignedFloats {
 public:
  void reserve(std::size_t count) {
    if (count <= count_) return;
    data_.reset(new (line) float[count]);
    count_ = count;
  }
  float* data() { return data_.get(); }

 private:
  static constexpr std::align_val_t line{64};
  struct Free {
    void operator()(float* data) const { ::operator delete[](data, line); }
  };
  std::unique_ptr<float[], Free> data_;
  std::size_t count_ = 0;
};

// Memory of one thread. `calls` are the instructions of the current block with their pointers.
struct Program::Scratch {
  struct Call {
    KernelCall kernel_call;
    Op op;
    const Grid* grid;
  };
  AlignedFloats registers;
  AlignedFloats uniforms;  // lane_group equal floats: constants, then inputs, then values
  std::vector<Operand> operands;
  std::vector<Call> calls;
  std::vector<const float*> input_lanes;
  std::vector<std::uint8_t> uniform_input, uniform_value;
};

// Of one program in one thread: its operands and calls, for one point. All values lie in one array, lane_group equal
// floats each: constants, inputs, results of instructions.
struct Program::Frame {
  std::uint64_t program = 0;  // number_; 0: none
  AlignedFloats values;
  std::vector<Operand> operands;
  std::vector<Scratch::Call> calls;
  std::array<const float*, 3> result{};
};

namespace {

std::uint64_t next_program_number() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

}  // namespace

Program::Program(const Graph& graph, NodeId result) : number_(next_program_number()) {
  const auto needed = needed_components(graph, result);
  std::vector<Sources> sources(graph.size());
  for (std::size_t i = 0; i < graph.size(); ++i)
    if (needed[i]) emit(graph, graph.node(NodeId(i)), needed[i], sources);
  result_ = sources[std::size_t(result)];
  result_components_ = component_count(graph, result);
  assign_registers();
}

// By node: a bit for each component that the result depends on.
std::vector<std::uint8_t> Program::needed_components(const Graph& graph, NodeId result) const {
  std::vector<std::uint8_t> needed(graph.size(), 0);
  needed[std::size_t(result)] = graph.is_vector(result) ? 7 : 1;
  for (std::size_t i = graph.size(); i-- > 0;) {
    if (!needed[i]) continue;
    const Node& n = graph.node(NodeId(i));
    const auto arguments = graph.arguments(n);
    for (std::size_t k = 0; k < arguments.size(); ++k) {
      std::uint8_t wanted = graph.is_vector(arguments[k]) ? 7 : 1;
      if (n.op == Op::Component) wanted = std::uint8_t(1 << n.parameter);
      if (n.op == Op::MakeVector) wanted = (needed[i] >> k) & 1;
      if (is_componentwise(n.op) && graph.is_vector(arguments[k])) wanted = needed[i];
      needed[std::size_t(arguments[k])] |= wanted;
    }
  }
  return needed;
}

Program::Source Program::constant(float value) {
  constants_.push_back(value);
  return {Source::Kind::Constant, std::int32_t(constants_.size()) - 1};
}

Program::Source Program::input(int slot, int component) {
  inputs_.push_back({slot, component});
  return {Source::Kind::Input, std::int32_t(inputs_.size()) - 1};
}

void Program::emit(const Graph& graph, const Node& n, std::uint8_t needed, std::vector<Sources>& sources) {
  Sources& mine = sources[std::size_t(&n - &graph.node(0))];
  const auto arguments = graph.arguments(n);
  auto source = [&](NodeId a, int c) { return sources[std::size_t(a)][graph.is_vector(a) ? std::size_t(c) : 0]; };
  auto value = [&] { return Source{Source::Kind::Value, std::int32_t(value_registers_.size())}; };
  const int components = n.type == ValueType::Vector ? 3 : 1;
  std::vector<Source> operands;
  for (int c = 0; c < components; ++c) {
    if (!(needed >> c & 1)) continue;
    Source& to = mine[std::size_t(c)];
    if (n.op == Op::Constant) to = constant(n.value);
    if (n.op == Op::Input) to = input(n.parameter, c);
    if (n.op == Op::Component) to = source(arguments[0], n.parameter);
    if (n.op == Op::MakeVector) to = source(arguments[std::size_t(c)], 0);
    if (!is_componentwise(n.op)) continue;
    operands.clear();
    for (NodeId a : arguments) operands.push_back(source(a, c));
    to = value();
    emit_call(graph, n, operands, 1);
  }
  if (!needs_kernel(n.op) || is_componentwise(n.op)) return;
  for (NodeId a : arguments)
    for (int c = 0; c < component_count(graph, a); ++c) operands.push_back(source(a, c));
  for (int c = 0; c < components; ++c) mine[std::size_t(c)] = {Source::Kind::Value, value().index + c};
  emit_call(graph, n, operands, components);
}

void Program::emit_call(const Graph& graph, const Node& n, std::span<const Source> operands, int value_count) {
  Instruction i;
  i.op = n.op;
  i.parameter = n.parameter;
  if (n.op == Op::Curve) {
    i.curve = std::int32_t(curves_.size());
    curves_.push_back(graph.curve_table(n.parameter));
    i.parameter = std::int32_t(curves_.back().pieces.size());
  }
  if (n.op == Op::GridValue || n.op == Op::GridGradient) i.grid = &graph.grid(n.parameter);
  i.first_operand = std::int32_t(operands_.size());
  i.operand_count = std::int32_t(operands.size());
  for (const Source& source : operands) {
    if (source.kind == Source::Kind::Input) input_operands_.push_back({source.index, std::int32_t(operands_.size())});
    operands_.push_back(source);
  }
  i.first_value = std::int32_t(value_registers_.size());
  i.value_count = value_count;
  value_registers_.resize(value_registers_.size() + std::size_t(value_count));
  instructions_.push_back(i);
  uses_random_ |= n.op == Op::Rand;
}

// A register is free again after the last instruction that reads it; results never stand where an operand is read.
void Program::assign_registers() {
  register_count_ = inputs_.size();
  for (std::size_t i = 0; i < inputs_.size(); ++i) inputs_[i].register_index = std::int32_t(i);
  std::vector<std::size_t> last_use(value_registers_.size(), 0);
  for (std::size_t i = 0; i < instructions_.size(); ++i)
    for (int k = 0; k < instructions_[i].operand_count; ++k)
      if (const Source& s = operands_[std::size_t(instructions_[i].first_operand + k)]; s.kind == Source::Kind::Value)
        last_use[std::size_t(s.index)] = i;
  for (const Source& s : result_)
    if (s.kind == Source::Kind::Value) last_use[std::size_t(s.index)] = instructions_.size();
  std::vector<std::vector<std::int32_t>> ending(instructions_.size() + 1);
  std::vector<std::int32_t> free;
  for (std::size_t i = 0; i < instructions_.size(); ++i) {
    for (int k = 0; k < instructions_[i].value_count; ++k) {
      const std::size_t value = std::size_t(instructions_[i].first_value + k);
      if (free.empty()) free.push_back(std::int32_t(register_count_++));
      value_registers_[value] = free.back();
      free.pop_back();
      ending[std::max(last_use[value], i)].push_back(value_registers_[value]);
    }
    free.insert(free.end(), ending[i].begin(), ending[i].end());
  }
}

bool Program::uses(int slot) const {
  return std::ranges::any_of(inputs_, [&](const InputUse& u) { return u.slot == slot; });
}

namespace {

const float* data_of(const Input& input, int component) {
  return component == 0 ? input.x : component == 1 ? input.y : input.z;
}

}  // namespace

// Binds sources to memory for one block: uniform values to lane_group equal floats, the others to registers.
struct Program::Bindings {
  Bindings(const Program& program, const Block& block, Scratch& scratch)
      : p(program),
        s(scratch),
        input_lanes(s.input_lanes),
        uniform_input(s.uniform_input),
        uniform_value(s.uniform_value) {
    input_lanes.assign(p.inputs_.size(), nullptr);
    uniform_input.assign(p.inputs_.size(), 0);
    uniform_value.assign(p.value_registers_.size(), 0);
    const std::size_t slots = p.constants_.size() + p.inputs_.size() + p.value_registers_.size();
    s.uniforms.reserve(slots * lane_group);
    s.registers.reserve(p.register_count_ * run_lanes);
    if (s.operands.size() < p.operands_.size()) s.operands.resize(p.operands_.size());
    for (std::size_t i = 0; i < p.constants_.size(); ++i) std::fill_n(uniform_slot(i), lane_group, p.constants_[i]);
    for (std::size_t i = 0; i < p.inputs_.size(); ++i) {
      const InputUse& use = p.inputs_[i];
      CHECK(std::size_t(use.slot) < block.inputs.size(), "input {} of {}", use.slot, block.inputs.size());
      const Input& in = block.inputs[std::size_t(use.slot)];
      const float* data = data_of(in, use.component);
      CHECK(data != nullptr, "input {} is missing", use.slot);
      uniform_input[i] = in.stride == 0;
      if (uniform_input[i]) std::fill_n(uniform_slot(p.constants_.size() + i), lane_group, *data);
    }
  }

  float* uniform_slot(std::size_t i) { return s.uniforms.data() + i * lane_group; }
  float* uniform_value_slot(std::size_t value) { return uniform_slot(p.constants_.size() + p.inputs_.size() + value); }
  float* register_of(std::int32_t index) { return s.registers.data() + std::size_t(index) * run_lanes; }

  bool is_uniform(const Source& source) const {
    if (source.kind == Source::Kind::Constant) return true;
    return source.kind == Source::Kind::Input ? uniform_input[std::size_t(source.index)]
                                              : uniform_value[std::size_t(source.index)];
  }
  Operand operand(const Source& source) {
    const std::size_t i = std::size_t(source.index);
    if (source.kind == Source::Kind::Constant) return {uniform_slot(i), 0};
    if (source.kind == Source::Kind::Input)
      return uniform_input[i] ? Operand{uniform_slot(p.constants_.size() + i), 0}
                              : Operand{input_lanes[i], -1};  // of the current run, see bind_inputs
    return uniform_value[i] ? Operand{uniform_value_slot(i), 0} : Operand{register_of(p.value_registers_[i]), -1};
  }

  // The call of an instruction, and whether it is uniform.
  Scratch::Call bind(const Instruction& in, bool has_keys, bool& uniform) {
    uniform = in.op != Op::Rand || !has_keys;
    for (int k = 0; k < in.operand_count; ++k) {
      const Source& source = p.operands_[std::size_t(in.first_operand + k)];
      uniform = uniform && is_uniform(source);
      s.operands[std::size_t(in.first_operand + k)] = operand(source);
    }
    Scratch::Call call{{{}, s.operands.data() + in.first_operand, in.operand_count, in.parameter}, in.op, in.grid};
    if (in.curve >= 0) call.kernel_call.pieces = p.curves_[std::size_t(in.curve)].pieces.data();
    for (int k = 0; k < in.value_count; ++k) {
      const std::size_t value = std::size_t(in.first_value + k);
      uniform_value[value] = uniform;
      call.kernel_call.out[std::size_t(k)] =
          uniform ? uniform_value_slot(value) : register_of(p.value_registers_[value]);
    }
    return call;
  }

  const Program& p;
  Scratch& s;
  std::vector<const float*>& input_lanes;  // by input
  std::vector<std::uint8_t>& uniform_input;
  std::vector<std::uint8_t>& uniform_value;
};

void Program::run(const KernelTable& kernels, const Block& block, float* x, float* y, float* z) const {
  if (block.count <= 0) return;
  const FloatMode mode;
  thread_local Scratch scratch;
  Bindings bindings(*this, block, scratch);
  scratch.calls.clear();
  for (const Instruction& in : instructions_) {
    bool uniform = false;
    const Scratch::Call call = bindings.bind(in, block.keys != nullptr, uniform);
    if (!uniform)
      scratch.calls.push_back(call);
    else if (in.op == Op::Rand)
      run_rand(call.kernel_call, nullptr, block.salt, 1, lane_group);
    else if (in.grid)
      run_grid(in.op, *in.grid, call.kernel_call, lane_group);
    else
      kernels.functions[std::size_t(in.op)](call.kernel_call, lane_group);
  }
  const std::array<float*, 3> out{x, y, z};
  for (int start = 0; start < block.count; start += run_lanes) {
    const int count = std::min(run_lanes, block.count - start);
    bind_inputs(bindings, block, start, count, kernels.lanes);
    run_calls(kernels, block, scratch, start, count);
    for (int c = 0; c < result_components_; ++c) {
      const Operand from = bindings.operand(result_[std::size_t(c)]);
      if (from.step_mask)
        std::memcpy(out[std::size_t(c)] + start, from.data, std::size_t(count) * sizeof(float));
      else
        std::fill_n(out[std::size_t(c)] + start, count, *from.data);
    }
  }
}

void Program::make_frame(Frame& frame) const {
  frame = {};
  const std::size_t first_value = constants_.size() + inputs_.size();
  frame.values.reserve((first_value + value_registers_.size()) * lane_group);
  const auto place = [&](const Source& source) {
    std::size_t i = std::size_t(source.index);
    if (source.kind == Source::Kind::Input) i += constants_.size();
    if (source.kind == Source::Kind::Value) i += first_value;
    return frame.values.data() + i * lane_group;
  };
  for (std::size_t i = 0; i < constants_.size(); ++i)
    std::fill_n(frame.values.data() + i * lane_group, lane_group, constants_[i]);
  for (const Source& source : operands_) frame.operands.push_back({place(source), 0});
  for (const Instruction& in : instructions_) {
    Scratch::Call call{{{}, frame.operands.data() + in.first_operand, in.operand_count, in.parameter}, in.op, in.grid};
    if (in.curve >= 0) call.kernel_call.pieces = curves_[std::size_t(in.curve)].pieces.data();
    for (int k = 0; k < in.value_count; ++k)
      call.kernel_call.out[std::size_t(k)] = place({Source::Kind::Value, in.first_value + k});
    frame.calls.push_back(call);
  }
  for (int c = 0; c < result_components_; ++c) frame.result[std::size_t(c)] = place(result_[std::size_t(c)]);
  frame.program = number_;
}

Vec3f Program::run_one(const KernelTable& kernels, std::span<const Vec3f> values, Key key, Key salt) const {
  constexpr std::size_t frame_count = 256;  // a thread: more programs than a scene's materials and rules use in turn
  thread_local std::vector<Frame> frames(frame_count);
  Frame& frame = frames[number_ % frame_count];
  if (frame.program != number_) make_frame(frame);
  float* input = frame.values.data() + constants_.size() * lane_group;
  for (const InputUse& use : inputs_) {
    CHECK(std::size_t(use.slot) < values.size(), "input {} of {}", use.slot, values.size());
    std::fill_n(input, lane_group, values[std::size_t(use.slot)][use.component]);
    input += lane_group;
  }
  const FloatMode mode;
  for (const Scratch::Call& call : frame.calls) {
    if (call.op == Op::Rand) {
      run_rand(call.kernel_call, &key, salt, 1, 1);
      std::fill_n(call.kernel_call.out[0] + 1, lane_group - 1, call.kernel_call.out[0][0]);
    } else if (call.grid) {
      run_grid(call.op, *call.grid, call.kernel_call, lane_group);
    } else {
      kernels.functions[std::size_t(call.op)](call.kernel_call, kernels.lanes);
    }
  }
  Vec3f result;
  for (int c = 0; c < result_components_; ++c) result[c] = *frame.result[std::size_t(c)];
  return result;
}

// Points the operands that are varying inputs at the run's lanes. Those of a run that does not end with a group (as
// many lanes as the kernels take at once) are copied, and the last group filled up with the last lane.
void Program::bind_inputs(Bindings& bindings, const Block& block, int start, int count, int group) const {
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    if (bindings.uniform_input[i]) continue;
    const Input& in = block.inputs[std::size_t(inputs_[i].slot)];
    const float* from = data_of(in, inputs_[i].component) + start;
    if (count % group != 0) {
      float* to = bindings.register_of(inputs_[i].register_index);
      std::memcpy(to, from, std::size_t(count) * sizeof(float));
      std::fill(to + count, to + padded(count, group), from[count - 1]);
      from = to;
    }
    bindings.input_lanes[i] = from;
  }
  for (const InputOperand& o : input_operands_)
    if (!bindings.uniform_input[std::size_t(o.input)])
      bindings.s.operands[std::size_t(o.operand)].data = bindings.input_lanes[std::size_t(o.input)];
}

void Program::run_calls(const KernelTable& kernels, const Block& block, const Scratch& scratch, int start,
                        int count) const {
  const int lanes = padded(count, kernels.lanes);
  for (const Scratch::Call& call : scratch.calls) {
    if (call.op == Op::Rand)
      run_rand(call.kernel_call, block.keys ? block.keys + start : nullptr, block.salt, count, lanes);
    else if (call.grid)
      run_grid(call.op, *call.grid, call.kernel_call, lanes);
    else
      kernels.functions[std::size_t(call.op)](call.kernel_call, lanes);
  }
}

}  // namespace meristem
