// Numbers, texts and arrays as bytes and back, little-endian: for film files. A reader throws DamagedBytes where a
// well-formed text of bytes would not end or count like that; it never reads beyond the end and never allocates more
// than the bytes can hold.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace meristem {

static_assert(std::endian::native == std::endian::little, "film files hold numbers as they lie in memory");

class DamagedBytes : public std::runtime_error {
 public:
  DamagedBytes() : std::runtime_error("it is damaged or not whole") {}
};

class ByteWriter {
 public:
  template <class T>
  void put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T));
  }
  void put_text(std::string_view text) {
    put(std::uint64_t(text.size()));
    bytes_.append(text);
  }
  template <class T, class Allocator>
  void put_array(const std::vector<T, Allocator>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    put(std::uint64_t(values.size()));
    bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : rest_(bytes) {}

  bool at_end() const { return rest_.empty(); }

  template <class T>
  T get() {
    T value;
    std::memcpy(&value, take(sizeof(T)).data(), sizeof(T));
    return value;
  }
  std::string_view take(std::uint64_t size) {
    if (size > rest_.size()) throw DamagedBytes();
    const std::string_view result = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return result;
  }
  std::string get_text() { return std::string(take(get<std::uint64_t>())); }
  template <class T>
  std::vector<T> get_array() {
    return get_array_as<std::vector<T>>();
  }
  template <class Vector>
  Vector get_array_as() {
    using T = typename Vector::value_type;
    const auto count = get<std::uint64_t>();
    if (count > rest_.size() / sizeof(T)) throw DamagedBytes();
    Vector values(count);
    if (count > 0) std::memcpy(static_cast<void*>(values.data()), take(count * sizeof(T)).data(), count * sizeof(T));
    return values;
  }
  // A count of things that take at least `size` bytes each.
  std::size_t get_count(std::size_t size) {
    const auto count = get<std::uint64_t>();
    if (count > rest_.size() / size) throw DamagedBytes();
    return std::size_t(count);
  }

 private:
  std::string_view rest_;
};

// CRC-32 as in zip and PNG (ISO-HDLC: polynomial 0x04C11DB7, reflected). About 400 MB/s.
std::uint32_t crc32(std::string_view bytes);

}  // namespace meristem
