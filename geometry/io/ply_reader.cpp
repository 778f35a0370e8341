#include "geometry/io/ply_reader.h"

#include "geometry/base/srgb.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <optional>
#include <string_view>

namespace meristem {

namespace {

enum class Format : std::uint8_t { Ascii, LittleEndian, BigEndian };
enum class Type : std::uint8_t { Int8, Uint8, Int16, Uint16, Int32, Uint32, Float, Double };

struct TypeName {
  std::string_view name;
  Type type;
  std::size_t bytes;
};
constexpr std::array type_names{
    TypeName{"char", Type::Int8, 1},     TypeName{"int8", Type::Int8, 1},     TypeName{"uchar", Type::Uint8, 1},
    TypeName{"uint8", Type::Uint8, 1},   TypeName{"short", Type::Int16, 2},   TypeName{"int16", Type::Int16, 2},
    TypeName{"ushort", Type::Uint16, 2}, TypeName{"uint16", Type::Uint16, 2}, TypeName{"int", Type::Int32, 4},
    TypeName{"int32", Type::Int32, 4},   TypeName{"uint", Type::Uint32, 4},   TypeName{"uint32", Type::Uint32, 4},
    TypeName{"float", Type::Float, 4},   TypeName{"float32", Type::Float, 4}, TypeName{"double", Type::Double, 8},
    TypeName{"float64", Type::Double, 8}};

// What becomes of a property.
enum class Use : std::uint8_t { None, X, Y, Z, U, V, Red, Green, Blue, Corners, CornerUv, Count };

struct Property {
  Type type = Type::Float;
  std::optional<Type> count_type = {};  // of a list
  Use use = Use::None;
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties = {};
  std::size_t line_at = 0;  // of its line in the header
};

std::size_t bytes_of(Type type) { return std::ranges::find(type_names, type, &TypeName::type)->bytes; }

Use use_of(std::string_view element, std::string_view property, bool is_list) {
  if (element == "face" && is_list)
    return property == "vertex_indices" || property == "vertex_index" ? Use::Corners
           : property == "texcoord"                                   ? Use::CornerUv
                                                                      : Use::None;
  if (element != "vertex" || is_list) return Use::None;
  if (property == "x") return Use::X;
  if (property == "y") return Use::Y;
  if (property == "z") return Use::Z;
  if (property == "s" || property == "u" || property == "texture_u") return Use::U;
  if (property == "t" || property == "v" || property == "texture_v") return Use::V;
  if (property == "red" || property == "r" || property == "diffuse_red") return Use::Red;
  if (property == "green" || property == "g" || property == "diffuse_green") return Use::Green;
  if (property == "blue" || property == "b" || property == "diffuse_blue") return Use::Blue;
  return Use::None;
}

class Reader {
 public:
  Reader(const std::shared_ptr<const SourceText>& source, Diagnostics& diagnostics)
      : source_(source), diagnostics_(diagnostics), at_(source->text.data()), end_(at_ + source->text.size()) {}

  PolygonMesh read() {
    if (!read_header()) return {};
    for (const Element& element : elements_)
      if (!read_element(element)) return {};
    if (mesh_.face_count() == 0) error(source_->text.data(), "the file holds no faces");
    mesh_.text = source_;
    return std::move(mesh_);
  }

 private:
  // ---- The header: lines of words

  bool read_header() {
    if (next_line() != "ply") return error(source_->text.data(), "a PLY file begins with the line \"ply\"");
    if (!read_format()) return false;
    for (;;) {
      if (at_ >= end_) return error(at_, "the header has no end: the line \"end_header\" is missing");
      const char* const start = at_;
      std::string_view line = next_line();
      const std::string_view keyword = take_word(line);
      if (keyword == "end_header") return check_elements(start);
      if (keyword == "comment" || keyword == "obj_info" || keyword.empty()) continue;
      if (keyword == "element" ? !add_element(start, line) : keyword != "property" || !add_property(start, line))
        return keyword == "element" || keyword == "property"
                   ? false
                   : error(start, fmt::format("\"{}\" is none of comment, element, property, end_header", keyword));
    }
  }

  bool read_format() {
    const char* const start = at_;
    std::string_view line = next_line();
    const std::string_view keyword = take_word(line), name = take_word(line), version = take_word(line);
    if (name == "ascii")
      format_ = Format::Ascii;
    else if (name == "binary_little_endian")
      format_ = Format::LittleEndian;
    else if (name == "binary_big_endian")
      format_ = Format::BigEndian;
    else
      return error(start, "expected \"format ascii 1.0\", binary_little_endian or binary_big_endian");
    return (keyword == "format" && version == "1.0") || error(start, "expected \"format ... 1.0\"");
  }

  bool add_element(const char* start, std::string_view line) {
    constexpr std::size_t most_elements = 64;
    Element element{std::string(take_word(line)), 0, {}, std::size_t(start - source_->text.data())};
    const std::string_view count = take_word(line);
    const auto [next, code] = std::from_chars(count.data(), count.data() + count.size(), element.count);
    if (element.name.empty() || code != std::errc{} || next != count.data() + count.size())
      return error(start, "expected \"element\", a name and a count");
    if (find(element.name)) return error(start, fmt::format("a second element \"{}\"", element.name));
    if (elements_.size() == most_elements) return error(start, fmt::format("more than {} elements", most_elements));
    elements_.push_back(std::move(element));
    return true;
  }

  bool add_property(const char* start, std::string_view line) {
    constexpr std::size_t most_properties = 256;
    if (elements_.empty()) return error(start, "a property before the first element");
    Element& element = elements_.back();
    if (element.properties.size() == most_properties)
      return error(start, fmt::format("more than {} properties", most_properties));
    Property property;
    std::string_view type = take_word(line);
    const bool is_list = type == "list";
    if (is_list) {
      property.count_type = type_named(take_word(line));
      type = take_word(line);
      if (!property.count_type || *property.count_type >= Type::Float)
        return error(start, "expected \"property list\", two types, the first of whole numbers, and a name");
    }
    const std::optional<Type> known = type_named(type);
    const std::string_view name = take_word(line);
    if (!known || name.empty())
      return error(start, fmt::format("\"{}\" is no type of PLY, or the property has no name", type));
    property.type = *known;
    property.use = use_of(element.name, name, is_list);
    if (property.use == Use::Corners && property.type >= Type::Float)
      return error(start, "indices of vertices are whole numbers");
    element.properties.push_back(property);
    return true;
  }

  // That the elements can be in the file, and are those of a mesh.
  bool check_elements(const char* header_end) {
    double least = 0;  // bytes of the body
    for (const Element& e : elements_) {
      double record = 0;
      if (e.properties.empty() && e.count > 0)
        return error(source_->text.data() + e.line_at, fmt::format("\"{}\" has no properties", e.name));
      for (const Property& p : e.properties)
        record += format_ == Format::Ascii ? 1 : double(bytes_of(p.count_type.value_or(p.type)));
      least += record * double(e.count);
      if (least > double(end_ - at_) + 1)
        return error(source_->text.data() + e.line_at,
                     fmt::format("{} of these do not fit into the file's {} bytes", e.count, source_->text.size()));
    }
    const Element* vertices = find("vertex");
    const Element* faces = find("face");
    if (!vertices || !has(*vertices, Use::X) || !has(*vertices, Use::Y) || !has(*vertices, Use::Z))
      return error(header_end, "a mesh has an element \"vertex\" with x, y and z");
    if (!faces || !has(*faces, Use::Corners))
      return error(header_end, "a mesh has an element \"face\" with a list vertex_indices");
    if (faces < vertices) return error(source_->text.data() + faces->line_at, "faces stand behind their vertices");
    return true;
  }

  const Element* find(std::string_view name) const {
    const auto e = std::ranges::find(elements_, name, &Element::name);
    return e == elements_.end() ? nullptr : &*e;
  }
  static bool has(const Element& e, Use use) {
    return std::ranges::find(e.properties, use, &Property::use) != e.properties.end();
  }

  static std::optional<Type> type_named(std::string_view name) {
    const auto t = std::ranges::find(type_names, name, &TypeName::name);
    return t == type_names.end() ? std::nullopt : std::optional(t->type);
  }

  // The next line without its end.
  std::string_view next_line() {
    const char* const start = at_;
    while (at_ < end_ && *at_ != '\n') ++at_;
    const char* last = at_;
    if (at_ < end_) ++at_;
    if (last > start && last[-1] == '\r') --last;
    return {start, std::size_t(last - start)};
  }

  static std::string_view take_word(std::string_view& line) {
    const std::size_t first = std::min(line.find_first_not_of(" \t"), line.size());
    const std::size_t last = std::min(line.find_first_of(" \t", first), line.size());
    const std::string_view word = line.substr(first, last - first);
    line.remove_prefix(last);
    return word;
  }

  // ---- The body: numbers

  bool read_element(const Element& element) {
    const bool is_vertex = element.name == "vertex";
    const bool has_uv = is_vertex && has(element, Use::U) && has(element, Use::V);
    const bool has_color = is_vertex && has(element, Use::Red) && has(element, Use::Green) && has(element, Use::Blue);
    if (is_vertex) mesh_.positions.reserve(element.count);
    if (element.name == "face" && format_ != Format::Ascii) mesh_.face_names.reserve(element.count);
    for (std::uint64_t i = 0; i < element.count; ++i) {
      record_ = {&element, i};
      values_.fill(0);
      const std::size_t first_corner = mesh_.corner_positions.size();
      corner_uv_.clear();
      for (const Property& p : element.properties)
        if (!read_property(p)) return false;
      if (is_vertex) {
        mesh_.positions.push_back({value(Use::X), value(Use::Y), value(Use::Z)});
        if (has_uv) mesh_.uv.push_back({value(Use::U), value(Use::V)});
        if (has_color) mesh_.colors.push_back(color(element));
      } else if (element.name == "face" && !end_face(first_corner)) {
        return false;
      }
    }
    if (is_vertex) vertex_uv_ = has_uv;
    return true;
  }

  double value(Use use) const { return values_[std::size_t(use)]; }

  // Whole numbers are steps to the largest of their type, of sRGB; others are linear.
  Vec3f color(const Element& element) const {
    Vec3f result;
    for (int i = 0; i < 3; ++i) {
      const auto use = Use(int(Use::Red) + i);
      const Type type = std::ranges::find(element.properties, use, &Property::use)->type;
      if (type >= Type::Float)
        result[i] = float(std::max(value(use), 0.0));
      else
        result[i] =
            float(linear_of_srgb(std::clamp(value(use) / (std::exp2(8.0 * double(bytes_of(type))) - 1), 0.0, 1.0)));
    }
    return result;
  }

  bool read_property(const Property& p) {
    if (!p.count_type) return read_number(p.type, values_[std::size_t(p.use)], p.use != Use::None);
    double count = 0;
    if (!read_number(*p.count_type, count, true)) return false;
    if (!(count >= 0) || count * (format_ == Format::Ascii ? 1 : double(bytes_of(p.type))) > double(end_ - at_) + 1)
      return body_error(fmt::format("a list of {} numbers does not fit into the file", count));
    for (std::uint64_t i = 0; i < std::uint64_t(count); ++i) {
      double number = 0;
      if (!read_number(p.type, number, p.use != Use::None)) return false;
      if (p.use == Use::Corners && !add_corner(number)) return false;
      if (p.use == Use::CornerUv) corner_uv_.push_back(number);
    }
    return true;
  }

  bool add_corner(double number) {
    if (!(number >= 0) || number >= double(mesh_.positions.size()) || number != std::floor(number))
      return body_error(fmt::format("there is no vertex {}; there are {}, from 0 on", number, mesh_.positions.size()));
    mesh_.corner_positions.push_back(std::uint32_t(number));
    return true;
  }

  bool end_face(std::size_t first) {
    if (std::string defect = mesh_.face_defect(first); !defect.empty()) return body_error(std::move(defect));
    const std::size_t count = mesh_.corner_positions.size() - first;
    const bool own_uv = corner_uv_.size() == 2 * count;
    for (std::size_t i = 0; i < count; ++i) {
      std::uint32_t uv = vertex_uv_ ? mesh_.corner_positions[first + i] : PolygonMesh::none;
      if (own_uv) {
        uv = std::uint32_t(mesh_.uv.size());
        mesh_.uv.push_back({corner_uv_[2 * i], corner_uv_[2 * i + 1]});
      }
      mesh_.corner_uv.push_back(uv);
    }
    if (mesh_.names.empty()) mesh_.names.emplace_back();
    mesh_.face_starts.push_back(std::uint32_t(mesh_.corner_positions.size()));
    mesh_.face_names.push_back(0);
    return true;
  }

  bool read_number(Type type, double& number, bool is_used) {
    if (format_ == Format::Ascii ? !read_text(type, number) : !read_bytes(type, number)) return false;
    if (!is_used || std::abs(number) <= PolygonMesh::largest_coordinate) return true;
    return body_error(std::isfinite(number)
                          ? fmt::format("a number is larger than {:g}", PolygonMesh::largest_coordinate)
                          : "a number is not finite");
  }

  bool read_text(Type type, double& number) {
    while (at_ < end_ && (*at_ == ' ' || *at_ == '\t' || *at_ == '\r' || *at_ == '\n')) ++at_;
    const char* const begin = at_ < end_ && *at_ == '+' ? at_ + 1 : at_;
    const auto [next, code] = std::from_chars(begin, end_, number);
    if (code == std::errc::invalid_argument) return body_error(at_ < end_ ? "expected a number" : "the file ends here");
    if (code != std::errc{}) return body_error("the number is out of range");
    if (type < Type::Float && number != std::floor(number)) return body_error("expected a whole number");
    at_ = next;
    return true;
  }

  bool read_bytes(Type type, double& number) {
    const std::size_t count = bytes_of(type);
    if (std::size_t(end_ - at_) < count) return body_error("the file ends");
    std::array<char, 8> bytes{};
    const bool reversed = format_ == Format::BigEndian;
    for (std::size_t i = 0; i < std::min(count, bytes.size()); ++i) bytes[i] = at_[reversed ? count - 1 - i : i];
    at_ += count;
    switch (type) {
      case Type::Int8: number = as<std::int8_t>(bytes); break;
      case Type::Uint8: number = as<std::uint8_t>(bytes); break;
      case Type::Int16: number = as<std::int16_t>(bytes); break;
      case Type::Uint16: number = as<std::uint16_t>(bytes); break;
      case Type::Int32: number = as<std::int32_t>(bytes); break;
      case Type::Uint32: number = as<std::uint32_t>(bytes); break;
      case Type::Float: number = double(as<float>(bytes)); break;
      case Type::Double: number = as<double>(bytes); break;
    }
    return true;
  }

  template <class T>
  static T as(const std::array<char, 8>& bytes) {
    static_assert(std::endian::native == std::endian::little);
    T value;
    std::memcpy(&value, bytes.data(), sizeof value);
    return value;
  }

  bool error(const char* where, std::string message) {
    diagnostics_.error({source_, std::size_t(where - source_->text.data())}, std::move(message));
    return false;
  }
  // In text at the place; a binary body has no lines, so the element's in the header.
  bool body_error(std::string message) {
    if (format_ == Format::Ascii) return error(at_, std::move(message));
    return error(source_->text.data() + record_.element->line_at,
                 fmt::format("in {} {}: {}", record_.element->name, record_.index, message));
  }

  const std::shared_ptr<const SourceText>& source_;
  Diagnostics& diagnostics_;
  const char* at_;
  const char* end_;
  Format format_ = Format::Ascii;
  std::vector<Element> elements_;
  struct {
    const Element* element = nullptr;
    std::uint64_t index = 0;
  } record_;                                              // being read
  std::array<double, std::size_t(Use::Count)> values_{};  // of its single properties, by use
  std::vector<double> corner_uv_;
  bool vertex_uv_ = false;
  PolygonMesh mesh_;
};

}  // namespace

PolygonMesh read_ply(const std::shared_ptr<const SourceText>& source, Diagnostics& diagnostics) {
  return Reader(source, diagnostics).read();
}

}  // namespace meristem
