#include "gemm_tiles.h"

#include <cpuid.h>
#include <immintrin.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>

namespace lodestone::inference {
namespace {

// One tile holds 16 rows of 64 bytes: 16 x 16 float32, or 16 x 32 bfloat16. A block of the result is 2 x 2
// tiles.
constexpr std::int64_t kTile = 16;
constexpr std::int64_t kBlock = 2 * kTile;

std::int64_t whole_blocks(std::int64_t count) { return (count + kBlock - 1) / kBlock * kBlock; }

__mmask16 first(std::int64_t count) {
  return static_cast<__mmask16>(count >= kTile ? 0xffff : count <= 0 ? 0 : (1 << count) - 1);
}

/// Palette 1: eight tiles of the full size.
struct alignas(64) TileShape {
  std::uint8_t palette = 1, start_row = 0, reserved[14] = {};
  std::uint16_t row_bytes[16] = {64, 64, 64, 64, 64, 64, 64, 64};
  std::uint8_t rows[16] = {16, 16, 16, 16, 16, 16, 16, 16};
};

/// [rows, k] with a stride to bfloat16 [padded rows, padded k], zeros in what is padded.
void round_rows(const float* matrix, std::int64_t rows, std::int64_t stride, std::int64_t k,
                std::int64_t padded_rows, std::int64_t padded_k, std::uint16_t* out) {
  for (std::int64_t i = 0; i < rows; ++i)
    for (std::int64_t j = 0; j < padded_k; j += kTile) {
      const __m512 values = _mm512_maskz_loadu_ps(first(k - j), matrix + i * stride + j);
      _mm256_storeu_si256(reinterpret_cast<__m256i*>(out + i * padded_k + j),
                          (__m256i)_mm512_cvtneps_pbh(values));
    }
  std::memset(out + rows * padded_k, 0,
              static_cast<std::size_t>((padded_rows - rows) * padded_k) * sizeof *out);
}

/// [k, n] to panels of 16 columns, in each [padded k / 2, 16] pairs of what lies below each other.
void pack_pairs(const RightSide<float>& b, std::int64_t padded_k, std::int64_t padded_n, std::uint32_t* out) {
  for (std::int64_t j = 0; j < padded_n; j += kTile)
    for (std::int64_t pair = 0; pair < padded_k / 2; ++pair) {
      const auto row = [&](std::int64_t i) {
        const __m512 values =
            i < b.k ? _mm512_maskz_loadu_ps(first(b.n - j), b.matrix + i * b.n + j) : _mm512_setzero_ps();
        return _mm512_cvtepu16_epi32((__m256i)_mm512_cvtneps_pbh(values));
      };
      const __m512i both = _mm512_or_si512(row(2 * pair), _mm512_slli_epi32(row(2 * pair + 1), 16));
      _mm512_store_si512(out + j * (padded_k / 2) + pair * kTile, both);
    }
}

/// The same of [n, k].
void pack_pairs_transposed(const RightSide<float>& b, std::int64_t padded_k, std::int64_t padded_n,
                           Bf16Scratch& scratch, std::uint32_t* out) {
  std::uint16_t* rounded = scratch.turned.at_least(padded_n * padded_k);
  round_rows(b.matrix, b.n, b.k, b.k, padded_n, padded_k, rounded);
  const std::int64_t pairs = padded_k / 2;
  const __m512i below =
      _mm512_mullo_epi32(_mm512_set_epi32(15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0),
                         _mm512_set1_epi32(static_cast<int>(pairs)));
  for (std::int64_t j = 0; j < padded_n; j += kTile)
    for (std::int64_t pair = 0; pair < pairs; ++pair)
      _mm512_store_si512(out + j * pairs + pair * kTile,
                         _mm512_i32gather_epi32(below, rounded + (j * pairs + pair) * 2, 4));
}

/// One block of the result, [32, 32].
void multiply_block(const std::uint16_t* a, const std::uint32_t* left, const std::uint32_t* right,
                    std::int64_t padded_k, float* block) {
  const std::int64_t stride = padded_k * static_cast<std::int64_t>(sizeof *a);
  _tile_zero(0);
  _tile_zero(1);
  _tile_zero(2);
  _tile_zero(3);
  for (std::int64_t k = 0; k < padded_k; k += 2 * kTile) {
    _tile_loadd(4, a + k, stride);
    _tile_loadd(5, a + kTile * padded_k + k, stride);
    _tile_loadd(6, left + k / 2 * kTile, 64);
    _tile_loadd(7, right + k / 2 * kTile, 64);
    _tile_dpbf16ps(0, 4, 6);
    _tile_dpbf16ps(1, 4, 7);
    _tile_dpbf16ps(2, 5, 6);
    _tile_dpbf16ps(3, 5, 7);
  }
  constexpr int kRowBytes = kBlock * sizeof(float);
  _tile_stored(0, block, kRowBytes);
  _tile_stored(1, block + kTile, kRowBytes);
  _tile_stored(2, block + kTile * kBlock, kRowBytes);
  _tile_stored(3, block + kTile * kBlock + kTile, kRowBytes);
}

/// What of a block lies in the result, finished and written.
void write_block(const float* block, std::int64_t i, std::int64_t j, std::int64_t m, std::int64_t n,
                 const Epilogue<float>& epilogue, float* out) {
  for (std::int64_t half = 0; half < kBlock && j + half < n; half += kTile) {
    const __mmask16 there = first(n - j - half);
    const __m512 bias = epilogue.bias != nullptr ? _mm512_maskz_loadu_ps(there, epilogue.bias + j + half)
                                                 : _mm512_setzero_ps();
    for (std::int64_t row = 0; row < std::min(kBlock, m - i); ++row) {
      const std::int64_t at = (i + row) * n + j + half;
      __m512 value = _mm512_add_ps(_mm512_load_ps(block + row * kBlock + half), bias);
      if (epilogue.relu) value = _mm512_max_ps(_mm512_setzero_ps(), value);  // NaN, the second, stays
      if (epilogue.mask != nullptr) {
        const __m512 mask = _mm512_maskz_loadu_ps(there, epilogue.mask + at);
        const __mmask16 off = _mm512_cmp_ps_mask(mask, _mm512_setzero_ps(), _CMP_LE_OQ);
        value = _mm512_mask_mov_ps(value, off, _mm512_setzero_ps());
      }
      _mm512_mask_storeu_ps(out + at, there, value);
    }
  }
}

}  // namespace

bool request_tiles() {
  unsigned a = 0, b = 0, c = 0, d = 0;
  if (__get_cpuid_count(7, 0, &a, &b, &c, &d) == 0) return false;
  const bool tiles = (d >> 22 & 1) != 0 && (d >> 24 & 1) != 0;  // bfloat16 products, and tiles at all
  if (!tiles || __get_cpuid_count(7, 1, &a, &b, &c, &d) == 0 || (a >> 5 & 1) == 0)
    return false;  // rounding to it
  constexpr int kRequestPermission = 0x1023, kTileData = 18;
  return ::syscall(SYS_arch_prctl, kRequestPermission, kTileData) == 0;
}

void multiply_by_tiles(const LeftSide<float>& a, const RightSide<float>& b, Bf16Scratch& scratch, float* out,
                       const Epilogue<float>& epilogue) {
  const std::int64_t m = whole_blocks(a.m), n = whole_blocks(b.n), k = whole_blocks(b.k);
  std::uint16_t* left = scratch.left.at_least(m * k);
  std::uint32_t* right = scratch.right.at_least(n * k / 2);
  round_rows(a.matrix, a.m, a.stride, b.k, m, k, left);
  if (b.transposed)
    pack_pairs_transposed(b, k, n, scratch, right);
  else
    pack_pairs(b, k, n, right);
  alignas(64) float block[kBlock * kBlock];
  const TileShape shape;
  _tile_loadconfig(&shape);
  for (std::int64_t j = 0; j < n; j += kBlock)
    for (std::int64_t i = 0; i < m; i += kBlock) {
      multiply_block(left + i * k, right + j * (k / 2), right + (j + kTile) * (k / 2), k, block);
      write_block(block, i, j, a.m, b.n, epilogue, out);
    }
  _tile_release();
}

}  // namespace lodestone::inference
