// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

/// Compiles a function once for every processor and once for those with wide vectors; the loader picks. Its body is a
/// plain loop that the compiler vectorises. The file that uses it is compiled with -ffp-contract=off (SIMD_FLAGS in
/// CMakeLists.txt), so that every version gives the same bits. Sanitizers cannot see through the loader's choice: with
/// them there is only the plain version.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define BIN_PICKING_SIMD __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define BIN_PICKING_SIMD
#endif

/// For what such a function calls in its loop: not inlined, it would be compiled once only, for every processor.
#if defined(__GNUC__)
#define BIN_PICKING_INLINE __attribute__((always_inline)) inline
#else
#define BIN_PICKING_INLINE inline
#endif
