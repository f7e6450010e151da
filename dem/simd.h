#pragma once

#include <algorithm>
#include <bitset>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <experimental/simd>

#if defined(__AVX2__)
#include <immintrin.h>
#endif

/// The one place that knows the width of the machine: packs of doubles and how they are loaded from
/// and stored to records. Laws are written once for S = double and S = Pack.
namespace grainlaw::dem {

using Pack = std::experimental::native_simd<double>;
using PackMask = Pack::mask_type;
inline constexpr std::size_t pack_width = Pack::size();

namespace detail {
template <class S>
struct MaskOf {
  using type = typename S::mask_type;
};
template <>
struct MaskOf<double> {
  using type = bool;
};
}  // namespace detail

/// What a comparison of two S gives: bool, or one per lane.
template <class S>
using Mask = typename detail::MaskOf<S>::type;

inline double select(bool condition, double yes, double no) {
  return condition ? yes : no;
}
[[gnu::always_inline]] inline Pack select(const PackMask& condition, const Pack& yes, Pack no) {
  std::experimental::where(condition, no) = yes;
  return no;
}

using std::experimental::max;
using std::experimental::min;
inline double max(double a, double b) {
  return std::max(a, b);
}
inline double min(double a, double b) {
  return std::min(a, b);
}

using std::abs;
using std::sqrt;
using std::experimental::abs;
using std::experimental::sqrt;

inline double sum(const Pack& a) {
  return std::experimental::reduce(a);
}
inline double largest(const Pack& a) {
  return std::experimental::hmax(a);
}
inline bool any(const PackMask& m) {
  return std::experimental::any_of(m);
}

/// 1 / sqrt(a), to the last bits [relative error below 4e-16].
inline double inverse_sqrt(double a) {
  return 1.0 / std::sqrt(a);
}
[[gnu::always_inline]] inline Pack inverse_sqrt(const Pack& a) {
#if defined(__AVX512F__)
  // An estimate of 14 bits and one correction of fourth order: with e = 1 - a y^2,
  // 1/sqrt(a) = y (1 + e/2 + 3/8 e^2 + 5/16 e^3 + ...).
  const Pack y(_mm512_maskz_rsqrt14_pd(0xff, static_cast<__m512d>(a)));
  const Pack e = 1.0 - a * y * y;
  return y + y * e * (0.5 + e * (0.375 + 0.3125 * e));
#else
  return 1.0 / std::experimental::sqrt(a);
#endif
}

/// 1 / a, to the last bits [relative error below 4e-16].
inline double reciprocal(double a) {
  return 1.0 / a;
}
[[gnu::always_inline]] inline Pack reciprocal(const Pack& a) {
#if defined(__AVX512F__)
  // As above: with e = 1 - a y, 1/a = y (1 + e + e^2 + e^3 + ...).
  const Pack y(_mm512_maskz_rcp14_pd(0xff, static_cast<__m512d>(a)));
  const Pack e = 1.0 - a * y;
  return y + y * e * (1.0 + e * (1.0 + e));
#else
  return 1.0 / a;
#endif
}

/// Lanes 0, 1, 2, ... as bits, and back.
inline std::uint32_t bits(const PackMask& mask) {
  auto word = static_cast<std::uint32_t>(mask.__to_bitset().to_ulong());
#if defined(__AVX512F__)
  // GCC 12 spills a mask as one byte and reads it back as a word, with three bytes of whatever was
  // there (seen under the thread sanitizer): no mask register from here on.
  asm("" : "+r"(word));
#endif
  return word;
}
inline PackMask mask_of(std::uint32_t bits) {
  return PackMask::__from_bitset(std::bitset<pack_width>(bits));
}

/// Half a cache line: four doubles.
using Row4 = std::experimental::simd<double, std::experimental::simd_abi::deduce_t<double, 4>>;

inline Row4 load_row4(const double* record) {
  return {record, std::experimental::vector_aligned};
}
inline void store(const Row4& row, double* record) {
  row.copy_to(record, std::experimental::vector_aligned);
}

/// A cache line: eight doubles, in as many packs as that takes.
struct Row8 {
  static constexpr std::size_t parts = 8 / pack_width;
  Pack part[parts];

  static Row8 load(const double* record) {
    Row8 row;
    for (std::size_t k = 0; k < parts; ++k) {
      row.part[k] = Pack(record + k * pack_width, std::experimental::vector_aligned);
    }
    return row;
  }
  void store(double* record) const {
    for (std::size_t k = 0; k < parts; ++k) {
      part[k].copy_to(record + k * pack_width, std::experimental::vector_aligned);
    }
  }
};
[[gnu::always_inline]] inline Row8 operator+(Row8 a, const Row8& b) {
  for (std::size_t k = 0; k < Row8::parts; ++k) a.part[k] += b.part[k];
  return a;
}
/// a + s b, element by element.
[[gnu::always_inline]] inline Row8 add_scaled(Row8 a, const Row8& s, const Row8& b) {
  for (std::size_t k = 0; k < Row8::parts; ++k) a.part[k] += s.part[k] * b.part[k];
  return a;
}

/// Columns of pack_width rows: column c holds element c of every row; and back.
#if defined(__AVX512F__)
[[gnu::always_inline]] inline void transpose(const __m512d (&in)[8], __m512d (&out)[8]) {
  __m512d t[8];
  for (std::size_t k = 0; k < 4; ++k) {
    t[2 * k] = _mm512_unpacklo_pd(in[2 * k], in[2 * k + 1]);
    t[2 * k + 1] = _mm512_unpackhi_pd(in[2 * k], in[2 * k + 1]);
  }
  for (int odd = 0; odd < 2; ++odd) {
    const __m512d a = _mm512_shuffle_f64x2(t[odd], t[2 + odd], 0x88);
    const __m512d b = _mm512_shuffle_f64x2(t[odd], t[2 + odd], 0xdd);
    const __m512d c = _mm512_shuffle_f64x2(t[4 + odd], t[6 + odd], 0x88);
    const __m512d d = _mm512_shuffle_f64x2(t[4 + odd], t[6 + odd], 0xdd);
    out[odd] = _mm512_shuffle_f64x2(a, c, 0x88);
    out[4 + odd] = _mm512_shuffle_f64x2(a, c, 0xdd);
    out[2 + odd] = _mm512_shuffle_f64x2(b, d, 0x88);
    out[6 + odd] = _mm512_shuffle_f64x2(b, d, 0xdd);
  }
}
[[gnu::always_inline]] inline void columns_of(const Row8 (&rows)[pack_width], Pack (&columns)[8]) {
  __m512d in[8], out[8];
  for (int k = 0; k < 8; ++k) in[k] = static_cast<__m512d>(rows[k].part[0]);
  transpose(in, out);
  for (int k = 0; k < 8; ++k) columns[k] = Pack(out[k]);
}
[[gnu::always_inline]] inline void rows_of(const Pack (&columns)[8], Row8 (&rows)[pack_width]) {
  __m512d in[8], out[8];
  for (int k = 0; k < 8; ++k) in[k] = static_cast<__m512d>(columns[k]);
  transpose(in, out);
  for (int k = 0; k < 8; ++k) rows[k].part[0] = Pack(out[k]);
}
/// The 4 x 4 transposes of both halves.
[[gnu::always_inline]] inline void transpose(const __m512d (&in)[4], __m512d (&out)[4]) {
  const __m512i low = _mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13);
  const __m512i high = _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15);
  for (int odd = 0; odd < 2; ++odd) {
    const __m512d a = odd ? _mm512_unpackhi_pd(in[0], in[1]) : _mm512_unpacklo_pd(in[0], in[1]);
    const __m512d b = odd ? _mm512_unpackhi_pd(in[2], in[3]) : _mm512_unpacklo_pd(in[2], in[3]);
    out[odd] = _mm512_permutex2var_pd(a, low, b);
    out[2 + odd] = _mm512_permutex2var_pd(a, high, b);
  }
}
[[gnu::always_inline]] inline void columns_of(const Row4 (&rows)[pack_width], Pack (&columns)[4]) {
  __m512d in[4], out[4];
  for (int k = 0; k < 4; ++k) {
    in[k] = _mm512_insertf64x4(_mm512_castpd256_pd512(static_cast<__m256d>(rows[k])),
                               static_cast<__m256d>(rows[k + 4]),
                               1);
  }
  transpose(in, out);
  for (int k = 0; k < 4; ++k) columns[k] = Pack(out[k]);
}
[[gnu::always_inline]] inline void rows_of(const Pack (&columns)[4], Row4 (&rows)[pack_width]) {
  __m512d in[4], out[4];
  for (int k = 0; k < 4; ++k) in[k] = static_cast<__m512d>(columns[k]);
  transpose(in, out);
  for (int k = 0; k < 4; ++k) {
    rows[k] = Row4(_mm512_castpd512_pd256(out[k]));
    rows[k + 4] = Row4(_mm512_extractf64x4_pd(out[k], 1));
  }
}
#else
template <std::size_t width, class Row>
void columns_by_element(const double (&table)[pack_width][width], Pack (&columns)[width]) {
  for (std::size_t c = 0; c < width; ++c) {
    columns[c] = Pack([&](auto lane) { return table[lane][c]; });
  }
}
[[gnu::always_inline]] inline void columns_of(const Row8 (&rows)[pack_width], Pack (&columns)[8]) {
  alignas(64) double table[pack_width][8];
  for (std::size_t k = 0; k < pack_width; ++k) rows[k].store(table[k]);
  columns_by_element<8, Row8>(table, columns);
}
[[gnu::always_inline]] inline void columns_of(const Row4 (&rows)[pack_width], Pack (&columns)[4]) {
  alignas(64) double table[pack_width][4];
  for (std::size_t k = 0; k < pack_width; ++k) store(rows[k], table[k]);
  columns_by_element<4, Row4>(table, columns);
}
[[gnu::always_inline]] inline void rows_of(const Pack (&columns)[8], Row8 (&rows)[pack_width]) {
  alignas(64) double table[pack_width][8];
  for (std::size_t k = 0; k < pack_width; ++k) {
    for (std::size_t c = 0; c < 8; ++c) table[k][c] = columns[c][k];
    rows[k] = Row8::load(table[k]);
  }
}
[[gnu::always_inline]] inline void rows_of(const Pack (&columns)[4], Row4 (&rows)[pack_width]) {
  alignas(64) double table[pack_width][4];
  for (std::size_t k = 0; k < pack_width; ++k) {
    for (std::size_t c = 0; c < 4; ++c) table[k][c] = columns[c][k];
    rows[k] = load_row4(table[k]);
  }
}
#endif

/// Writes the chosen ones of pack_width words, in order, and returns their number; up to
/// pack_width words may be written.
[[gnu::always_inline]] inline std::size_t compress(const std::uint32_t* from,
                                                   std::uint32_t chosen,
                                                   std::uint32_t* to) {
#if defined(__AVX512VL__)
  const __m256i words = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(to),
                      _mm256_maskz_compress_epi32(static_cast<__mmask8>(chosen), words));
  return static_cast<std::size_t>(__builtin_popcount(chosen));
#else
  std::size_t count = 0;
  for (std::size_t k = 0; k < pack_width; ++k) {
    to[count] = from[k];
    count += chosen >> k & 1u;
  }
  return count;
#endif
}

}  // namespace grainlaw::dem
