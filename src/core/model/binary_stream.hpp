// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace bin_picking
{
/// The data end before the value, or a size is larger than what is left.
class StreamEnd : public std::runtime_error
{
public:
  StreamEnd() : std::runtime_error("the data end early") {}
};

/// Numbers without padding inside, whose bytes can be written as they are.
template <typename T>
constexpr bool IS_PLAIN = std::is_trivially_copyable<T>::value && !std::is_pointer<T>::value;

/// Appends values to a block of bytes.
class BinaryWriter
{
public:
  template <typename T>
  void value(const T& v)
  {
    static_assert(IS_PLAIN<T>, "write the members one by one");
    raw(&v, sizeof(T));
  }
  void text(const std::string& v)
  {
    value(static_cast<std::uint64_t>(v.size()));
    raw(v.data(), v.size());
  }
  template <typename T>
  void array(const std::vector<T>& v)
  {
    static_assert(IS_PLAIN<T>, "write the members one by one");
    value(static_cast<std::uint64_t>(v.size()));
    raw(v.data(), v.size() * sizeof(T));
  }
  void vectors(const std::vector<Eigen::Vector3f>& v)
  {
    value(static_cast<std::uint64_t>(v.size()));
    raw(v.data(), v.size() * sizeof(Eigen::Vector3f));
  }
  template <typename Scalar, int Rows, int Columns>
  void matrix(const Eigen::Matrix<Scalar, Rows, Columns>& v)
  {
    raw(v.data(), sizeof(Scalar) * Rows * Columns);
  }

  const std::vector<char>& bytes() const { return bytes_; }
  /// The bytes; the writer is empty afterwards.
  std::vector<char> take() { return std::move(bytes_); }

private:
  void raw(const void* data, std::size_t size)
  {
    const auto* begin = static_cast<const char*>(data);
    bytes_.insert(bytes_.end(), begin, begin + size);
  }

  std::vector<char> bytes_;
};

/// Reads them back in the same order. Sizes are compared with the bytes that are left before anything is allocated.
class BinaryReader
{
public:
  BinaryReader(const char* begin, std::size_t size) : next_(begin), left_(size) {}

  template <typename T>
  T value()
  {
    static_assert(IS_PLAIN<T>, "read the members one by one");
    T v;
    raw(&v, sizeof(T));
    return v;
  }
  std::string text()
  {
    std::string v(count(1), '\0');
    raw(&v[0], v.size());
    return v;
  }
  template <typename T>
  std::vector<T> array()
  {
    std::vector<T> v(count(sizeof(T)));
    raw(v.data(), v.size() * sizeof(T));
    return v;
  }
  std::vector<Eigen::Vector3f> vectors()
  {
    std::vector<Eigen::Vector3f> v(count(sizeof(Eigen::Vector3f)));
    raw(v.data(), v.size() * sizeof(Eigen::Vector3f));
    return v;
  }
  template <typename Matrix>
  Matrix matrix()
  {
    Matrix v;
    raw(v.data(), sizeof(typename Matrix::Scalar) * static_cast<std::size_t>(v.size()));
    return v;
  }
  /// Number of elements of at least `element_size` bytes each that follow.
  std::size_t count(std::size_t element_size)
  {
    const auto n = value<std::uint64_t>();
    if (n > left_ / element_size)
      throw StreamEnd();
    return static_cast<std::size_t>(n);
  }
  std::size_t left() const { return left_; }

private:
  void raw(void* data, std::size_t size)
  {
    if (size > left_)
      throw StreamEnd();
    if (size > 0)
      std::memcpy(data, next_, size);
    next_ += size;
    left_ -= size;
  }

  const char* next_;
  std::size_t left_;
};
}  // namespace bin_picking
