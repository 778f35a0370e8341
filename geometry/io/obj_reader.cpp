#include "geometry/io/obj_reader.h"

#include "geometry/base/srgb.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>
#include <unordered_map>

namespace meristem {

namespace {

constexpr int max_errors = 20;

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

class Reader {
 public:
  Reader(const std::shared_ptr<const SourceText>& source, Diagnostics& diagnostics)
      : source_(source), diagnostics_(diagnostics), at_(source->text.data()), end_(at_ + source->text.size()) {}

  PolygonMesh read() {
    constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";  // some editors put it before UTF-8
    if (std::string_view(source_->text).starts_with(byte_order_mark)) at_ += byte_order_mark.size();
    while (at_ < end_ && errors_ < max_errors) {
      read_statement(next_word());
      skip_line();
    }
    if (errors_ == 0 && mesh_.face_count() == 0) error(source_->text.data(), "the file holds no faces");
    if (mesh_.colors.size() != mesh_.positions.size()) mesh_.colors.clear();
    mesh_.text = source_;
    return std::move(mesh_);
  }

 private:
  void read_statement(std::string_view keyword) {
    if (keyword == "v")
      read_position();
    else if (keyword == "vt")
      read_uv();
    else if (keyword == "f")
      read_face();
    else if (keyword == "g")
      set_name(group_);
    else if (keyword == "usemtl")
      set_name(material_);
  }

  void read_position() {
    Vec3d p;
    const bool is_good = read_number(p.x) && read_number(p.y) && read_number(p.z);
    mesh_.positions.push_back(p);  // if it is wrong, too: those behind it keep their numbers
    if (is_good) read_color();
  }

  // Three more numbers, as programs for scans write them; one is a weight. Of no vertex if not of all.
  void read_color() {
    const char* const start = at_;
    double number[3] = {};
    int count = 0;
    while (count < 3 && !at_line_end()) {
      const auto [next, code] = std::from_chars(at_, end_, number[count]);
      if (code != std::errc{} || !std::isfinite(number[count])) break;
      at_ = next;
      ++count;
    }
    if (count == 3 && mesh_.colors.size() + 1 == mesh_.positions.size()) {
      Vec3f color;
      for (int i = 0; i < 3; ++i) color[i] = float(linear_of_srgb(std::clamp(number[i], 0.0, 1.0)));
      mesh_.colors.push_back(color);
    }
    at_ = start;
  }

  void read_uv() {
    Vec2d uv;
    if (!read_number(uv.x)) return;
    if (!at_line_end() && !read_number(uv.y)) return;  // one coordinate is allowed
    mesh_.uv.push_back(uv);
  }

  void read_face() {
    const char* const start = at_;
    const std::size_t first = mesh_.corner_positions.size();
    bool good = true;
    while (good && !at_line_end()) good = read_corner();
    if (good)
      if (std::string defect = mesh_.face_defect(first); !defect.empty()) good = error(start, std::move(defect));
    if (!good) {
      mesh_.corner_positions.resize(first);
      mesh_.corner_uv.resize(first);
      return;
    }
    mesh_.face_starts.push_back(std::uint32_t(mesh_.corner_positions.size()));
    mesh_.face_names.push_back(current_name());
    mesh_.face_places.push_back(std::uint32_t(start - source_->text.data()));
  }

  // p, p/t, p//n or p/t/n
  bool read_corner() {
    std::uint32_t position = 0, uv = PolygonMesh::none;
    if (!read_index(mesh_.positions.size(), "vertex", position)) return false;
    if (take('/')) {
      if (at_ < end_ && *at_ != '/' && !read_index(mesh_.uv.size(), "texture coordinate", uv)) return false;
      if (take('/')) skip_word();  // the normal
    }
    if (at_ < end_ && !is_blank(*at_) && *at_ != '\n' && *at_ != '\\' && *at_ != '#')
      return error(at_, "expected a blank between the corners of a face");
    mesh_.corner_positions.push_back(position);
    mesh_.corner_uv.push_back(uv);
    return true;
  }

  bool read_index(std::size_t count, const char* what, std::uint32_t& index) {
    long long written = 0;
    const auto [next, code] = std::from_chars(at_, end_, written);
    if (code == std::errc::invalid_argument) return error(at_, fmt::format("expected the number of a {}", what));
    const long long n = static_cast<long long>(count);
    const long long zero_based = written > 0 ? written - 1 : n + written;
    if (code != std::errc{} || written == 0 || zero_based < 0 || zero_based >= n)
      return error(at_, fmt::format("there is no {} {}; there are {} so far", what,
                                    std::string_view(at_, std::size_t(next - at_)), count));
    at_ = next;
    index = std::uint32_t(zero_based);
    return true;
  }

  bool read_number(double& number) {
    skip_blanks();
    const char* begin = at_ < end_ && *at_ == '+' ? at_ + 1 : at_;
    const auto [next, code] = std::from_chars(begin, end_, number);
    if (code == std::errc::invalid_argument) return error(at_, "expected a number");
    if (code != std::errc{} || !std::isfinite(number)) return error(at_, "the number is not finite or out of range");
    if (std::abs(number) > PolygonMesh::largest_coordinate)
      return error(at_, fmt::format("a coordinate is at most {:g}", PolygonMesh::largest_coordinate));
    at_ = next;
    return true;
  }

  // The rest of the line, blanks at its ends removed.
  void set_name(std::string& name) {
    skip_blanks();
    const char* begin = at_;
    while (at_ < end_ && *at_ != '\n' && *at_ != '#') ++at_;
    const char* last = at_;
    while (last > begin && is_blank(last[-1])) --last;
    name.assign(begin, last);
    name_is_stale_ = true;
  }

  std::uint32_t current_name() {
    if (!name_is_stale_) return name_;
    const std::string& name = group_.empty() ? material_ : group_;
    const auto [entry, is_new] = name_index_.try_emplace(name, std::uint32_t(mesh_.names.size()));
    if (is_new) mesh_.names.push_back(name);
    name_is_stale_ = false;
    return name_ = entry->second;
  }

  bool take(char c) {
    if (at_ >= end_ || *at_ != c) return false;
    ++at_;
    return true;
  }

  // Blanks, and ends of lines behind a backslash.
  void skip_blanks() {
    for (;;) {
      while (at_ < end_ && is_blank(*at_)) ++at_;
      if (at_ >= end_ || *at_ != '\\') return;
      const char* next = at_ + 1;
      if (next < end_ && *next == '\r') ++next;
      if (next >= end_ || *next != '\n') return;
      at_ = next + 1;
    }
  }

  bool at_line_end() {
    skip_blanks();
    return at_ >= end_ || *at_ == '\n' || *at_ == '#';
  }

  std::string_view next_word() {
    skip_blanks();
    const char* begin = at_;
    skip_word();
    return {begin, std::size_t(at_ - begin)};
  }

  void skip_word() {
    while (at_ < end_ && !is_blank(*at_) && *at_ != '\n' && *at_ != '#') ++at_;
  }

  // To the beginning of the next line; a backslash before the end of this one joins the next to it.
  void skip_line() {
    for (; at_ < end_; ++at_) {
      if (*at_ != '\n') continue;
      const char* last = at_;
      if (last > source_->text.data() && last[-1] == '\r') --last;
      if (last > source_->text.data() && last[-1] == '\\') continue;
      ++at_;
      return;
    }
  }

  bool error(const char* where, std::string message) {
    ++errors_;
    diagnostics_.error({source_, std::size_t(where - source_->text.data())}, std::move(message));
    return false;
  }

  const std::shared_ptr<const SourceText>& source_;
  Diagnostics& diagnostics_;
  const char* at_;
  const char* end_;
  int errors_ = 0;
  PolygonMesh mesh_;
  std::string group_, material_;
  std::unordered_map<std::string, std::uint32_t> name_index_;
  std::uint32_t name_ = 0;
  bool name_is_stale_ = true;
};

}  // namespace

PolygonMesh read_obj(const std::shared_ptr<const SourceText>& source, Diagnostics& diagnostics) {
  return Reader(source, diagnostics).read();
}

}  // namespace meristem
