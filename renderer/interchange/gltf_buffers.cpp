#include "renderer/interchange/gltf_buffers.h"

#include "geometry/io/whole_file.h"
#include "renderer/interchange/foreign_scene.h"
#include "renderer/language/jsonc_reader.h"

#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <optional>

namespace meristem {

namespace fs = std::filesystem;

namespace {

constexpr std::uint32_t file_magic = 0x46546C67, json_chunk = 0x4E4F534A, binary_chunk = 0x004E4942;

// Component types of the specification.
enum : int { int8 = 5120, uint8 = 5121, int16 = 5122, uint16 = 5123, uint32 = 5125, float32 = 5126 };

std::size_t bytes_of(int component) {
  switch (component) {
    case int8:
    case uint8: return 1;
    case int16:
    case uint16: return 2;
    case uint32:
    case float32: return 4;
    default: return 0;
  }
}

int width_of(std::string_view type) {
  return type == "SCALAR" ? 1 : type == "VEC2" ? 2 : type == "VEC3" ? 3 : type == "VEC4" ? 4 : 0;
}

template <class T>
T read_as(const char* at) {
  T value;
  std::memcpy(&value, at, sizeof value);
  return value;
}

}  // namespace

std::size_t gltf_count(const Value& object, const char* name, std::size_t fallback) {
  const Value* v = object.find(name);
  const bool good = v && v->kind == Value::Kind::Number && v->number >= 0 && v->number <= 0x1p53 &&
                    v->number == std::floor(v->number);
  return good ? std::size_t(v->number) : fallback;
}

double gltf_number(const Value* object, const char* name, double fallback) {
  const Value* v = object ? object->find(name) : nullptr;
  return v && v->kind == Value::Kind::Number && std::isfinite(v->number) ? v->number : fallback;
}

GltfBuffers::GltfBuffers(const std::string& path, Diagnostics& diagnostics)
    : diagnostics_(diagnostics), folder_(fs::absolute(path).parent_path().string()) {
  std::string reason;
  std::optional<std::string> text = read_whole_file(path, reason);
  if (!text) {
    error({}, reason);
    return;
  }
  if (text->size() >= 4 && read_as<std::uint32_t>(text->data()) == file_magic) {
    binary_ = std::move(*text);
    read_glb(path);
  } else {
    read_json(path, std::move(*text));
  }
  read_buffers();
}

// 12 bytes of header, then chunks of length, type and bytes: JSON, and perhaps the first buffer.
void GltfBuffers::read_glb(const std::string& path) {
  const std::string file = std::move(binary_);
  binary_.clear();
  const Location nowhere{std::make_shared<SourceText>(SourceText{path, ""}), 0};
  if (file.size() < 20 || read_as<std::uint32_t>(file.data() + 4) != 2) {
    error(nowhere, "the file is no binary glTF 2.0");
    return;
  }
  std::string json;
  for (std::size_t at = 12; at + 8 <= file.size();) {
    const std::size_t size = read_as<std::uint32_t>(file.data() + at);
    const std::uint32_t type = read_as<std::uint32_t>(file.data() + at + 4);
    if (size > file.size() - at - 8) {
      error(nowhere, fmt::format("a chunk of {} bytes does not fit into the file", size));
      return;
    }
    if (type == json_chunk && json.empty()) json = file.substr(at + 8, size);
    if (type == binary_chunk && binary_.empty()) binary_ = file.substr(at + 8, size);
    at += 8 + size;
  }
  read_json(path, std::move(json));
}

void GltfBuffers::read_json(const std::string& path, std::string text) {
  if (text.find_first_not_of(" \t\r\n") == text.npos) {
    error({std::make_shared<SourceText>(SourceText{path, ""}), 0}, "the file is empty; expected glTF 2.0");
    return;
  }
  json_ = read_jsonc(std::make_shared<SourceText>(SourceText{path, std::move(text)}), diagnostics_);
  const Value* asset = json_.find("asset");
  const Value* version = asset ? asset->find("version") : nullptr;
  if (!version || !version->text.starts_with("2.")) error(json_.location, "the file is no glTF 2.0");
}

void GltfBuffers::read_buffers() {
  const Value* list = json_.find("buffers");
  for (const Value& buffer : list ? list->items : std::vector<Value>{}) {
    const Value* uri = buffer.find("uri");
    const std::size_t size = gltf_count(buffer, "byteLength", 0);
    std::string bytes;
    if (!uri) {
      bytes = buffers_.empty() ? std::move(binary_) : std::string();
    } else if (uri->text.starts_with("data:")) {
      error(uri->location, "data inside of the JSON is not read: save it as .glb, or with files beside it");
    } else if (const std::string path = path_inside(folder_, uri->text); path.empty()) {
      error(uri->location, fmt::format("\"{}\" leaves the folder of the file", uri->text));
    } else {
      std::string reason;
      if (auto read = read_whole_file(path, reason))
        bytes = std::move(*read);
      else
        error(uri->location, reason);
    }
    if (bytes.size() < size)
      error(buffer.location, fmt::format("the buffer has {} of its {} bytes", bytes.size(), size));
    buffers_.push_back(std::move(bytes));
  }
}

const Value* GltfBuffers::item(const char* array, const Value* index) {
  if (!index) return nullptr;
  const Value* list = json_.find(array);
  const std::size_t count = list ? list->items.size() : 0;
  if (index->kind == Value::Kind::Number && index->number >= 0 && index->number < double(count) &&
      index->number == std::floor(index->number))
    return &list->items[std::size_t(index->number)];
  error(index->location, fmt::format("there is no such item of \"{}\"; there are {}, from 0 on", array, count));
  return nullptr;
}

std::string_view GltfBuffers::view(const Value* index) {
  const Value* view = item("bufferViews", index);
  if (!view) return {};
  const Value* buffer = view->find("buffer");
  if (!item("buffers", buffer)) {
    if (!buffer) error(view->location, "a view names its buffer");
    return {};
  }
  const std::string& bytes = buffers_[std::size_t(buffer->number)];
  const std::size_t offset = gltf_count(*view, "byteOffset", 0), size = gltf_count(*view, "byteLength", 0);
  if (offset > bytes.size() || size > bytes.size() - offset) {
    error(view->location, fmt::format("bytes {} to {} leave the buffer of {}", offset, offset + size, bytes.size()));
    return {};
  }
  return std::string_view(bytes).substr(offset, size);
}

bool GltfBuffers::accessor(const Value* index, Accessor& a) {
  const Value* value = item("accessors", index);
  if (!value) return false;
  if (value->find("sparse")) return error(value->location, "sparse accessors are not read");
  const Value* type = value->find("type");
  const Value* view_index = value->find("bufferView");
  if (!view_index) return error(value->location, "an accessor without a view holds nothing");
  a.component = int(gltf_count(*value, "componentType", 0));
  a.width = width_of(type ? type->text : "");
  a.count = gltf_count(*value, "count", 0);
  a.normalized = value->find("normalized") && value->find("normalized")->boolean;
  const std::size_t size = bytes_of(a.component) * std::size_t(a.width);
  if (size == 0) return error(value->location, "the accessor has no type that is read here");
  const std::string_view bytes = view(view_index);
  const Value* view_value = item("bufferViews", view_index);
  if (!view_value) return false;
  a.stride = gltf_count(*view_value, "byteStride", size);
  const std::size_t offset = gltf_count(*value, "byteOffset", 0);
  // Checked without a product that could overflow
  const bool fits = a.stride >= size && a.stride <= 252 + size && offset <= bytes.size() && a.count > 0 &&
                    size <= bytes.size() - offset && (a.count - 1) <= (bytes.size() - offset - size) / a.stride;
  if (!fits) return error(value->location, fmt::format("{} items do not fit into {} bytes", a.count, bytes.size()));
  a.first = bytes.data() + offset;
  return true;
}

double GltfBuffers::component(const Accessor& a, std::size_t item, int i) const {
  const char* at = a.first + item * a.stride + std::size_t(i) * bytes_of(a.component);
  switch (a.component) {
    case int8: return a.normalized ? std::max(read_as<std::int8_t>(at) / 127.0, -1.0) : read_as<std::int8_t>(at);
    case uint8: return a.normalized ? read_as<std::uint8_t>(at) / 255.0 : read_as<std::uint8_t>(at);
    case int16: return a.normalized ? std::max(read_as<std::int16_t>(at) / 32767.0, -1.0) : read_as<std::int16_t>(at);
    case uint16: return a.normalized ? read_as<std::uint16_t>(at) / 65535.0 : read_as<std::uint16_t>(at);
    case uint32: return read_as<std::uint32_t>(at);
    default: return double(read_as<float>(at));
  }
}

std::vector<float> GltfBuffers::floats(const Value* index, int width) {
  Accessor a;
  if (!accessor(index, a)) return {};
  if (a.width != width) {
    error(index->location, fmt::format("expected an accessor of {} numbers an item, found {}", width, a.width));
    return {};
  }
  std::vector<float> result;
  result.reserve(a.count * std::size_t(width));
  for (std::size_t item = 0; item < a.count; ++item)
    for (int i = 0; i < width; ++i) {
      const auto x = float(component(a, item, i));
      if (!std::isfinite(x)) {
        error(index->location, fmt::format("item {} of the accessor is not finite", item));
        return {};
      }
      result.push_back(x);
    }
  return result;
}

std::vector<std::uint32_t> GltfBuffers::indices(const Value* index, std::size_t vertices) {
  Accessor a;
  if (!accessor(index, a)) return {};
  if (a.width != 1 || a.component == float32) {
    error(index->location, "indices are whole numbers");
    return {};
  }
  std::vector<std::uint32_t> result;
  result.reserve(a.count);
  for (std::size_t item = 0; item < a.count; ++item) {
    const double n = component(a, item, 0);
    if (!(n >= 0 && n < double(vertices))) {
      error(index->location, fmt::format("index {} is {}; there are {} vertices", item, n, vertices));
      return {};
    }
    result.push_back(std::uint32_t(n));
  }
  return result;
}

bool GltfBuffers::error(const Location& where, std::string message) {
  diagnostics_.error(where, std::move(message));
  return false;
}

}  // namespace meristem
